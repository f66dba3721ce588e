"""A small renderer of glTF 2.0, written from the Khronos specification alone.

It shares nothing with the project: own reader, PNG decoder, rasteriser and BRDF (appendix B and the
texts of KHR_materials_ior, specular, clearcoat, emissive_strength, KHR_texture_transform). Light is
one distant source and an even sky without shadows. Needs numpy; JPEG and WebP need PIL, Draco the
program draco_decoder.
"""
import base64
import io
import json
import os
import shutil
import struct
import subprocess
import tempfile
import urllib.parse
import zlib

import numpy as np

try:
    import PIL.Image
except ImportError:
    PIL = None


class Unreadable(Exception):
    """The file needs something that is not here."""


# ---- files

def decoded_png(data):
    """RGBA of an 8-bit PNG without interlacing; None: of another kind."""
    at, packed, palette, alphas = 8, b"", None, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        chunk = data[at + 8:at + 8 + size]
        at += size + 12
        if kind == b"IHDR":
            width, height, depth, color, _, _, interlaced = struct.unpack(">IIBBBBB", chunk)
        elif kind == b"IDAT":
            packed += chunk
        elif kind == b"PLTE":
            palette = np.frombuffer(chunk, np.uint8).reshape(-1, 3)
        elif kind == b"tRNS":
            alphas = chunk
    if depth != 8 or interlaced or (alphas and color != 3):
        return None
    count = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[color]
    raw = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + width * count)
    rows = np.zeros((height + 1, width + 1, count), np.int32)
    for y in range(height):
        kind, line = raw[y, 0], raw[y, 1:].reshape(width, count).astype(np.int32)
        up = rows[y]
        if kind == 0:
            rows[y + 1, 1:] = line
        elif kind == 1:
            rows[y + 1, 1:] = np.cumsum(line, 0) & 255
        elif kind == 2:
            rows[y + 1, 1:] = (line + up[1:]) & 255
        else:
            left = rows[y + 1]
            for x in range(width):
                a, b, c = left[x], up[x + 1], up[x]
                if kind == 3:
                    guess = (a + b) >> 1
                else:
                    p = a + b - c
                    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
                    guess = np.where((pa <= pb) & (pa <= pc), a, np.where(pb <= pc, b, c))
                left[x + 1] = (line[x] + guess) & 255
    pixels = rows[1:, 1:].astype(np.uint8)
    out = np.full((height, width, 4), 255, np.uint8)
    if color == 3:
        table = np.full((256, 4), 255, np.uint8)
        table[:len(palette), :3] = palette
        table[:len(alphas), 3] = np.frombuffer(alphas, np.uint8)
        return table[pixels[..., 0]]
    if color in (0, 4):
        out[..., :3] = pixels[..., :1]
    else:
        out[..., :3] = pixels[..., :3]
    if color in (4, 6):
        out[..., 3] = pixels[..., -1]
    return out


def decoded_image(data):
    if data[:4] == b"\x89PNG" and (PIL is None or len(data) < 100000):
        found = decoded_png(data)
        if found is not None:
            return found
    if PIL is None:
        raise Unreadable("an image that needs PIL")
    return np.array(PIL.Image.open(io.BytesIO(data)).convert("RGBA"))


TYPES = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class File:
    def __init__(self, path):
        self.folder = os.path.dirname(path)
        data = open(path, "rb").read()
        self.chunk = b""
        if data[:4] == b"glTF":
            size = struct.unpack("<I", data[12:16])[0]
            self.json = json.loads(data[20:20 + size])
            self.chunk = data[20 + size + 8:]
        else:
            self.json = json.loads(data)
        self.buffers, self.images, self.streams = {}, {}, {}

    def list(self, name):
        return self.json.get(name, [])

    def bytes_of(self, uri):
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        return open(os.path.join(self.folder, urllib.parse.unquote(uri)), "rb").read()

    def buffer(self, index):
        if index not in self.buffers:
            uri = self.json["buffers"][index].get("uri")
            self.buffers[index] = self.bytes_of(uri) if uri else self.chunk
        return self.buffers[index]

    def view(self, index):
        view = self.json["bufferViews"][index]
        if "EXT_meshopt_compression" in view.get("extensions", {}):
            raise Unreadable("meshopt compression")
        start = view.get("byteOffset", 0)
        return self.buffer(view["buffer"])[start:start + view["byteLength"]]

    def accessor(self, index):
        a = self.json["accessors"][index]
        kind, width, count = np.dtype(TYPES[a["componentType"]]), WIDTHS[a["type"]], a["count"]
        if "sparse" in a:
            raise Unreadable("sparse accessors")
        if "bufferView" not in a:
            return np.zeros((count, width))
        view = self.json["bufferViews"][a["bufferView"]]
        stride = view.get("byteStride", kind.itemsize * width)
        data = np.frombuffer(self.view(a["bufferView"]), np.uint8, offset=a.get("byteOffset", 0))
        rows = np.lib.stride_tricks.as_strided(data, (count, kind.itemsize * width), (stride, 1))
        out = np.ascontiguousarray(rows).view(kind).reshape(count, width)
        if a.get("normalized"):
            return np.maximum(out / float(np.iinfo(kind).max), -1)
        return out.astype(np.float64) if kind == np.float32 else out

    def image(self, index):
        if index not in self.images:
            image = self.json["images"][index]
            data = self.bytes_of(image["uri"]) if "uri" in image else self.view(image["bufferView"])
            self.images[index] = decoded_image(data)
        return self.images[index]

    def draco(self, view):
        """Positions, normals and texture coordinates of a stream, by corner."""
        if view not in self.streams:
            program = shutil.which("draco_decoder")
            if not program:
                raise Unreadable("Draco compression (the program draco_decoder)")
            with tempfile.TemporaryDirectory() as folder:
                packed, text = os.path.join(folder, "a.drc"), os.path.join(folder, "a.obj")
                open(packed, "wb").write(self.view(view))
                subprocess.run([program, "-i", packed, "-o", text], check=True, stdout=subprocess.DEVNULL)
                lists, corners = {"v": [], "vt": [], "vn": []}, []
                for line in open(text):
                    words = line.split()
                    if words and words[0] in lists:
                        lists[words[0]].append([float(w) for w in words[1:]])
                    elif words and words[0] == "f":
                        corners.append([[int(i) - 1 if i else -1 for i in (w.split("/") + ["", ""])[:3]]
                                        for w in words[1:]])
            corners = np.array(corners)
            out = {"POSITION": np.array(lists["v"])[corners[..., 0]]}
            if lists["vt"]:
                out["TEXCOORD_0"] = np.array(lists["vt"])[corners[..., 1]][..., :2]
            if lists["vn"]:
                out["NORMAL"] = np.array(lists["vn"])[corners[..., 2]]
            self.streams[view] = out
        return self.streams[view]


# ---- geometry

def matrix_of(node):
    if "matrix" in node:
        return np.array(node["matrix"]).reshape(4, 4).T
    m = np.eye(4)
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
    m[:3, :3] = turn * np.array(node.get("scale", [1, 1, 1]))
    m[:3, 3] = node.get("translation", [0, 0, 0])
    return m


def unit(v):
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-30)


class Surface:
    """A primitive in world axes: arrays by triangle and corner."""

    def __init__(self, file, primitive, matrix):
        attributes = primitive["attributes"]
        packed = primitive.get("extensions", {}).get("KHR_draco_mesh_compression")
        if packed:
            get = file.draco(packed["bufferView"]).get
        else:
            count = file.json["accessors"][attributes["POSITION"]]["count"]
            indices = file.accessor(primitive["indices"])[:, 0].astype(int) if "indices" in primitive \
                else np.arange(count)
            mode = primitive.get("mode", 4)
            if mode == 4:
                corners = indices[:len(indices) // 3 * 3].reshape(-1, 3)
            elif mode == 5:
                corners = np.array([indices[i:i + 3] if i % 2 == 0 else indices[[i + 1, i, i + 2]]
                                    for i in range(len(indices) - 2)]).reshape(-1, 3)
            else:
                corners = np.array([[indices[0], indices[i + 1], indices[i + 2]]
                                    for i in range(len(indices) - 2)]).reshape(-1, 3)

            def get(name):
                return file.accessor(attributes[name])[corners] if name in attributes else None
        points = get("POSITION") @ matrix[:3, :3].T + matrix[:3, 3]
        mirrored = np.linalg.det(matrix[:3, :3]) < 0
        faces = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
        self.points, self.faces = points, -faces if mirrored else faces
        normals = get("NORMAL")
        cofactor = np.linalg.inv(matrix[:3, :3]).T
        self.normals = np.repeat(self.faces[:, None], 3, 1) if normals is None else normals @ cofactor.T
        self.normals = unit(self.normals)
        self.uvs = {k: get(f"TEXCOORD_{k}") for k in (0, 1)}
        colors = get("COLOR_0")
        self.colors = None if colors is None else colors[..., :3]
        materials = file.list("materials")
        self.material = materials[primitive["material"]] if "material" in primitive else {}


def surfaces(file):
    scene = file.json["scenes"][file.json.get("scene", 0)]
    out = []

    def visit(index, above):
        node = file.json["nodes"][index]
        if "skin" in node or "EXT_mesh_gpu_instancing" in node.get("extensions", {}):
            raise Unreadable("skins or instances")
        matrix = above @ matrix_of(node)
        if "mesh" in node:
            for primitive in file.json["meshes"][node["mesh"]]["primitives"]:
                if primitive.get("mode", 4) >= 4:
                    out.append(Surface(file, primitive, matrix))
        for child in node.get("children", []):
            visit(child, matrix)

    for root in scene["nodes"]:
        visit(root, np.eye(4))
    return out


# ---- materials

def linear(codes):
    return np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)


def wrapped(at, size, mode):
    if mode == 33071:
        return np.clip(at, 0, size - 1)
    if mode == 33648:
        at = at % (2 * size)
        return np.where(at < size, at, 2 * size - 1 - at)
    return at % size


def lookup(file, surface, info, picked, shares, srgb):
    """Bilinear RGBA of a texture at points of triangles; colours decoded before they are mixed."""
    transform = info.get("extensions", {}).get("KHR_texture_transform", {})
    uv = surface.uvs[transform.get("texCoord", info.get("texCoord", 0))]
    at = np.einsum("nk,nkc->nc", shares, uv[picked])
    at = at * np.array(transform.get("scale", [1, 1]))
    turn = transform.get("rotation", 0)
    at = np.stack([np.cos(turn) * at[:, 0] + np.sin(turn) * at[:, 1],
                   np.cos(turn) * at[:, 1] - np.sin(turn) * at[:, 0]], -1) + transform.get("offset", [0, 0])
    texture = file.json["textures"][info["index"]]
    webp = texture.get("extensions", {}).get("EXT_texture_webp", {}).get("source")
    image = file.image(webp if webp is not None else texture["source"])
    table = np.arange(256) / 255
    tables = np.stack([linear(table) if srgb else table] * 3 + [table])
    sampler = file.json["samplers"][texture["sampler"]] if "sampler" in texture else {}
    height, width = image.shape[:2]
    x, y = at[:, 0] * width - 0.5, at[:, 1] * height - 0.5
    x0, y0 = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = (x - x0)[:, None], (y - y0)[:, None]
    columns = [wrapped(x0 + k, width, sampler.get("wrapS", 10497)) for k in (0, 1)]
    rows = [wrapped(y0 + k, height, sampler.get("wrapT", 10497)) for k in (0, 1)]

    def texel(row, column):
        return tables[np.arange(4), image[row, column]]
    upper = texel(rows[0], columns[0]) * (1 - fx) + texel(rows[0], columns[1]) * fx
    lower = texel(rows[1], columns[0]) * (1 - fx) + texel(rows[1], columns[1]) * fx
    return upper * (1 - fy) + lower * fy


def base_of(file, surface, picked, shares):
    pbr = surface.material.get("pbrMetallicRoughness", {})
    base = np.tile(np.array(pbr.get("baseColorFactor", [1, 1, 1, 1]), float), (len(picked), 1))
    if "baseColorTexture" in pbr and surface.uvs[0] is not None:
        base = base * lookup(file, surface, pbr["baseColorTexture"], picked, shares, True)
    if surface.colors is not None:
        base[:, :3] *= np.einsum("nk,nkc->nc", shares, surface.colors[picked])
    return base


def bumped(file, surface, picked, shares, normals, info):
    """The normal of a normal map. The tangent is that of each triangle's texture coordinates."""
    uv, points = surface.uvs[info.get("texCoord", 0)][picked], surface.points[picked]
    d1, d2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    e1, e2 = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    turned = np.sign(d1[:, 0] * d2[:, 1] - d1[:, 1] * d2[:, 0])
    along = (e1 * d2[:, 1:] - e2 * d1[:, 1:]) * turned[:, None]
    along = unit(along - normals * np.sum(along * normals, -1, keepdims=True))
    # v runs downwards in the file, green upwards
    across = np.cross(normals, along) * np.where(turned > 0, -1, 1)[:, None]
    texel = lookup(file, surface, info, picked, shares, False)[:, :3] * 2 - 1
    scale = info.get("scale", 1)
    flat = (np.abs(np.sum(along * along, -1)) < 0.5) | (turned == 0)
    out = texel[:, :1] * scale * along + texel[:, 1:2] * scale * across + texel[:, 2:] * normals
    return np.where(flat[:, None], normals, unit(out))


def dot(a, b):
    return np.sum(a * b, -1)


def ggx(alpha, nl, nv, nh):
    a2 = np.maximum(alpha, 1e-3) ** 2
    d = a2 / (np.pi * (nh * nh * (a2 - 1) + 1) ** 2)
    return d / 2 / (nl * np.sqrt(a2 + (1 - a2) * nv * nv) + nv * np.sqrt(a2 + (1 - a2) * nl * nl))


def shaded(file, surface, picked, shares, to_viewer, to_light, sky, options):
    """Radiance over that of a white plate under the same light: RGB of points of triangles."""
    material = surface.material
    more = material.get("extensions", {})
    pbr = material.get("pbrMetallicRoughness", {})
    base = base_of(file, surface, picked, shares)[:, :3]
    textured = surface.uvs[0] is not None
    metallic, rough = pbr.get("metallicFactor", 1), pbr.get("roughnessFactor", 1)
    ones = np.ones(len(picked))
    metallic, rough = metallic * ones, rough * ones
    if "metallicRoughnessTexture" in pbr and textured:
        texel = lookup(file, surface, pbr["metallicRoughnessTexture"], picked, shares, False)
        metallic, rough = metallic * texel[:, 2], rough * texel[:, 1]
    normals = unit(np.einsum("nk,nkc->nc", shares, surface.normals[picked]))
    plain = normals
    back = dot(surface.faces[picked], to_viewer) < 0
    if "normalTexture" in material and textured:
        normals = bumped(file, surface, picked, shares, normals, material["normalTexture"])
    normals, plain = np.where(back[:, None], -normals, normals), np.where(back[:, None], -plain, plain)
    nl, nv = dot(normals, to_light), np.maximum(dot(normals, to_viewer), 1e-3)
    half = unit(to_light + to_viewer)
    nh, vh = np.clip(dot(normals, half), 0, 1), dot(half, to_viewer)
    lit = nl > 0
    nl = np.maximum(nl, 1e-3)
    ior = more.get("KHR_materials_ior", {}).get("ior", 1.5)
    specular = more.get("KHR_materials_specular", {})
    weight = specular.get("specularFactor", 1) * ones
    color = np.tile(np.array(specular.get("specularColorFactor", [1, 1, 1]), float), (len(picked), 1))
    if "specularTexture" in specular:
        weight = weight * lookup(file, surface, specular["specularTexture"], picked, shares, False)[:, 3]
    if "specularColorTexture" in specular:
        color = color * lookup(file, surface, specular["specularColorTexture"], picked, shares, True)[:, :3]
    f0 = np.minimum(((ior - 1) / (ior + 1)) ** 2 * color, 1)
    rise = ((1 - vh) ** 5)
    fr = f0 + (1 - f0) * (rise * ones)[:, None]
    lobe = ggx(rough ** 2, nl, nv, nh)[:, None]
    dielectric = (1 - weight * fr.max(-1))[:, None] * base / np.pi + weight[:, None] * fr * lobe
    metal = lobe * (base + (1 - base) * (rise * ones)[:, None])
    f = dielectric + (metal - dielectric) * metallic[:, None]
    flat = (1 - metallic)[:, None] * base + metallic[:, None] * base + (1 - metallic)[:, None] * weight[:, None] * f0
    coat = more.get("KHR_materials_clearcoat", {})
    strength = coat.get("clearcoatFactor", 0) * ones
    if "clearcoatTexture" in coat and textured:
        strength = strength * lookup(file, surface, coat["clearcoatTexture"], picked, shares, False)[:, 0]
    if np.any(strength > 0):
        slope = coat.get("clearcoatRoughnessFactor", 0) * ones
        if "clearcoatRoughnessTexture" in coat and textured:
            slope = slope * lookup(file, surface, coat["clearcoatRoughnessTexture"], picked, shares, False)[:, 1]
        if "clearcoatNormalTexture" in coat and textured:
            plain = bumped(file, surface, picked, shares, plain, coat["clearcoatNormalTexture"])
        cl, cv = np.maximum(dot(plain, to_light), 1e-3), np.maximum(dot(plain, to_viewer), 1e-3)
        fresnel = (strength * (0.04 + 0.96 * (1 - cv) ** 5))[:, None]
        peak = ggx(slope ** 2, cl, cv, np.clip(dot(plain, half), 0, 1))[:, None] * (cl / nl)[:, None]
        f = f + (peak - f) * fresnel
        flat = flat + (1 - flat) * fresnel
    out = np.pi * f * (nl * lit)[:, None] + sky * flat
    if options.get("emission", True):
        emissive = np.array(material.get("emissiveFactor", [0, 0, 0]), float)
        emissive = emissive * more.get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1)
        if "emissiveTexture" in material and textured and np.any(emissive):
            emissive = emissive * lookup(file, surface, material["emissiveTexture"], picked, shares, True)[:, :3]
        out = out + emissive
    return out


# ---- images

def fragments(surface, right, up, toward, middle, scale, size):
    """Pixels that triangles cover: pixel, depth (larger is nearer), triangle, shares of its corners."""
    p = surface.points - middle
    x = p @ right * scale + size / 2
    y = size / 2 - p @ up * scale
    z = p @ toward
    area = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0])
    facing = surface.faces @ toward
    seen = np.abs(area) > 1e-9
    if not surface.material.get("doubleSided", False):
        seen &= facing > 0
    low_x, low_y = np.ceil(x.min(1) - 0.5).astype(int), np.ceil(y.min(1) - 0.5).astype(int)
    wide = np.maximum(np.floor(x.max(1) - 0.5).astype(int) - low_x, np.floor(y.max(1) - 0.5).astype(int) - low_y) + 1
    seen &= wide > 0
    side = 1
    while True:
        chosen = np.nonzero(seen & (wide <= side) & (wide > side // 2 if side > 1 else True))[0]
        step = max(1, 2000000 // (side * side))
        dy, dx = np.divmod(np.arange(side * side), side)
        for first in range(0, len(chosen), step):
            t = chosen[first:first + step]
            px, py = low_x[t, None] + dx, low_y[t, None] + dy
            cx, cy = px + 0.5, py + 0.5
            w1 = ((cx - x[t, None, 0]) * (y[t, 2] - y[t, 0])[:, None] -
                  (cy - y[t, None, 0]) * (x[t, 2] - x[t, 0])[:, None]) / area[t, None]
            w2 = ((cy - y[t, None, 0]) * (x[t, 1] - x[t, 0])[:, None] -
                  (cx - x[t, None, 0]) * (y[t, 1] - y[t, 0])[:, None]) / area[t, None]
            inside = (w1 >= 0) & (w2 >= 0) & (w1 + w2 <= 1) & (px >= 0) & (px < size) & (py >= 0) & (py < size)
            row, column = np.nonzero(inside)
            if len(row) == 0:
                continue
            shares = np.stack([1 - w1[row, column] - w2[row, column], w1[row, column], w2[row, column]], -1)
            yield (py * size + px)[row, column], np.sum(shares * z[t[row]], -1), t[row], shares
        if side > 2 * size or not np.any(seen & (wide > side)):
            return
        side *= 2


def rendered(file, parts, toward, to_light, middle, radius, size, sky=0.2, **options):
    """RGB and coverage, orthographic, seen from `toward`."""
    up = np.array([0, 1, 0]) if abs(toward[1]) < 0.9 else np.array([0, 0, 1])
    right = unit(np.cross(up, toward))
    up = np.cross(toward, right)
    scale = size / (2 * radius)
    depth = np.full(size * size, -np.inf)
    owner, triangle = np.full(size * size, -1), np.zeros(size * size, int)
    corner = np.zeros((size * size, 3))
    for index, surface in enumerate(parts):
        masked = surface.material.get("alphaMode") == "MASK"
        for pixel, z, t, shares in fragments(surface, right, up, toward, middle, scale, size):
            if masked:
                there = base_of(file, surface, t, shares)[:, 3] >= surface.material.get("alphaCutoff", 0.5)
                pixel, z, t, shares = pixel[there], z[there], t[there], shares[there]
            order = np.argsort(z, kind="stable")
            pixel, z, t, shares = pixel[order], z[order], t[order], shares[order]
            last = np.full(size * size, -1)
            last[pixel] = np.arange(len(pixel))
            place = np.nonzero(last >= 0)[0]
            found = last[place]
            nearer = z[found] > depth[place] + 1e-6 * radius
            place, found = place[nearer], found[nearer]
            depth[place], owner[place], triangle[place], corner[place] = z[found], index, t[found], shares[found]
    image = np.zeros((size * size, 3))
    for index, surface in enumerate(parts):
        place = np.nonzero(owner == index)[0]
        if len(place):
            image[place] = shaded(file, surface, triangle[place], corner[place], toward, to_light, sky, options)
    return image.reshape(size, size, 3), (owner >= 0).reshape(size, size)


def bounds(parts):
    points = np.concatenate([s.points.reshape(-1, 3) for s in parts])
    low, high = points.min(0), points.max(0)
    return (low + high) / 2, np.linalg.norm(high - low) / 2


VIEWS = [((0.6, 0.35, 0.72), (0.2, 0.6, 0.77)), ((-0.75, -0.3, 0.59), (-0.9, 0.4, 0.2)),
         ((-0.3, 0.55, -0.78), (0.3, 0.8, -0.52)), ((0.7, -0.62, -0.35), (0.95, -0.1, -0.3))]


def compared(first, second, size=192, **options):
    """How the second file looks against the first: mean and p99 error, brightness, worst of no view.

    Radiance is that of a camera whose white is a white plate that faces the light; the error of a
    pixel is over its own value, or that of the mean where it is darker.
    """
    files = [File(first), File(second)]
    parts = [surfaces(f) for f in files]
    middle, radius = bounds(parts[0])
    errors, totals, images, bare = [], np.zeros(2), [], np.zeros(2)
    off = 0.0
    for toward, to_light in VIEWS:
        toward, to_light = unit(np.array(toward)), unit(np.array(to_light))
        pair = [rendered(f, p, toward, to_light, middle, radius, size, **options) for f, p in zip(files, parts)]
        (a, seen_a), (b, seen_b) = pair
        a, b = np.minimum(a, 1), np.minimum(b, 1)
        either = seen_a | seen_b
        bare += [np.sum(either & ~seen_b), np.sum(either)]
        a, b = a[either], b[either]
        totals += [a.sum(), b.sum()]
        off += np.abs(a - b).sum()
        errors.append((a, b))
        images.append(pair)
    a, b = (np.concatenate([e[k] for e in errors]) for k in (0, 1))
    relative = np.abs(a - b) / np.maximum(a, a.mean())
    return {"mean": off / totals[0], "p99": float(np.percentile(relative, 99)), "brightness": totals[1] / totals[0],
            "missing": bare[0] / bare[1], "images": images}


def png_of(image):
    codes = np.clip(image, 0, 1)
    codes = np.where(codes <= 0.0031308, 12.92 * codes, 1.055 * codes ** (1 / 2.4) - 0.055)
    codes = (codes * 255 + 0.5).astype(np.uint8)
    height, width = codes.shape[:2]
    raw = b"".join(b"\0" + codes[y].tobytes() for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))
