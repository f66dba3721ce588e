// The schema of glTF 2.0 as a table. Private to importers/gltf.
#pragma once

namespace panwright::importers::gltf {

// Schema. A line is a type of object and its properties, `name=kind`, `name!=kind` if required:
//   id.X, ids.X, map.X   an index into the array X of the root; several; several by name
//   int(a,b) num(a,b)    within bounds, the last optional; num(>a): above a
//   nums:N(a,b)          N numbers; nums: any number of them; bounds: the same, or none
//   enum(…) word(…)      one of these; others are a deviation, not an error
//   obj.T list.T         an object of type T; one or more of them
//   bool str strs uri any ints
// `@E T|U` is what the extension E adds to objects of the types T and U; in a column of its own.
// Khronos Group, "glTF 2.0 Specification" and the schemas of its registered extensions.
inline constexpr const char* kSchema = R"(
root asset!=obj.asset extensionsUsed=strs extensionsRequired=strs accessors=list.accessor animations=list.animation buffers=list.buffer bufferViews=list.bufferView cameras=list.camera images=list.image materials=list.material meshes=list.mesh nodes=list.node samplers=list.sampler scene=id.scenes scenes=list.scene skins=list.skin textures=list.texture
asset copyright=str generator=str version!=str minVersion=str
accessor bufferView=id.bufferViews byteOffset=int(0) componentType!=enum(5120,5121,5122,5123,5125,5126) normalized=bool count!=int(1) type!=word(SCALAR,VEC2,VEC3,VEC4,MAT2,MAT3,MAT4) max=bounds min=bounds sparse=obj.sparse name=str
sparse count!=int(1) indices!=obj.sparseIndices values!=obj.sparseValues
sparseIndices bufferView!=id.bufferViews byteOffset=int(0) componentType!=enum(5121,5123,5125)
sparseValues bufferView!=id.bufferViews byteOffset=int(0)
buffer uri=uri byteLength!=int(1) name=str
bufferView buffer!=id.buffers byteOffset=int(0) byteLength!=int(1) byteStride=int(4,252) target=enum(34962,34963) name=str
mesh primitives!=list.primitive weights=nums name=str
primitive attributes!=map.accessors indices=id.accessors material=id.materials mode=int(0,6) targets=maps.accessors
node camera=id.cameras children=ids.nodes skin=id.skins matrix=nums:16 mesh=id.meshes rotation=nums:4(-1,1) scale=nums:3 translation=nums:3 weights=nums name=str
skin inverseBindMatrices=id.accessors skeleton=id.nodes joints!=ids.nodes name=str
scene nodes=ids.nodes name=str
material pbrMetallicRoughness=obj.pbr normalTexture=obj.normalTextureInfo occlusionTexture=obj.occlusionTextureInfo emissiveTexture=obj.textureInfo emissiveFactor=nums:3(0,1) alphaMode=word(OPAQUE,MASK,BLEND) alphaCutoff=num(0) doubleSided=bool name=str
pbr baseColorFactor=nums:4(0,1) baseColorTexture=obj.textureInfo metallicFactor=num(0,1) roughnessFactor=num(0,1) metallicRoughnessTexture=obj.textureInfo
textureInfo index!=id.textures texCoord=int(0)
normalTextureInfo index!=id.textures texCoord=int(0) scale=num
occlusionTextureInfo index!=id.textures texCoord=int(0) strength=num(0,1)
texture sampler=id.samplers source=id.images name=str
sampler magFilter=enum(9728,9729) minFilter=enum(9728,9729,9984,9985,9986,9987) wrapS=enum(33071,33648,10497) wrapT=enum(33071,33648,10497) name=str
image uri=uri mimeType=word(image/jpeg,image/png,image/webp,image/ktx2,image/avif,image/vnd-ms.dds) bufferView=id.bufferViews name=str
camera type!=word(perspective,orthographic) orthographic=obj.orthographic perspective=obj.perspective name=str
perspective aspectRatio=num(>0) yfov!=num(>0) zfar=num(>0) znear!=num(>0)
orthographic xmag!=num ymag!=num zfar!=num(>0) znear!=num(0)
animation channels!=list.channel samplers!=list.animationSampler name=str
channel sampler!=int(0) target!=obj.target
target node=id.nodes path!=word(translation,rotation,scale,weights,pointer)
animationSampler input!=id.accessors interpolation=word(LINEAR,STEP,CUBICSPLINE) output!=id.accessors
light color=nums:3(0,1) intensity=num(0) range=num(>0) type!=word(directional,point,spot) spot=obj.spot name=str
spot innerConeAngle=num(0,1.5707963267948966) outerConeAngle=num(>0,1.5707963267948966)
variant name!=str
variantMapping material!=id.materials variants!=ids.variants name=str
articulation name!=str stages!=list.stage pointingVector=nums:3
stage name!=str type!=word(xTranslate,yTranslate,zTranslate,xRotate,yRotate,zRotate,xScale,yScale,zScale,uniformScale) minimumValue=num maximumValue=num initialValue=num
@KHR_draco_mesh_compression primitive bufferView!=id.bufferViews attributes!=ints
@KHR_mesh_quantization nowhere
@EXT_mesh_gpu_instancing node attributes!=map.accessors
@EXT_meshopt_compression bufferView buffer!=id.buffers byteOffset=int(0) byteLength!=int(1) byteStride!=int(1,256) count!=int(1) mode!=word(ATTRIBUTES,TRIANGLES,INDICES) filter=word(NONE,OCTAHEDRAL,QUATERNION,EXPONENTIAL,COLOR)
@KHR_meshopt_compression bufferView buffer!=id.buffers byteOffset=int(0) byteLength!=int(1) byteStride!=int(1,256) count!=int(1) mode!=word(ATTRIBUTES,TRIANGLES,INDICES) filter=word(NONE,OCTAHEDRAL,QUATERNION,EXPONENTIAL,COLOR)
@EXT_meshopt_compression buffer fallback=bool
@KHR_meshopt_compression buffer fallback=bool
@KHR_texture_transform textureInfo|normalTextureInfo|occlusionTextureInfo offset=nums:2 rotation=num scale=nums:2 texCoord=int(0)
@EXT_texture_webp texture source=id.images
@KHR_texture_basisu texture source=id.images
@KHR_materials_ior material ior=num(0)
@KHR_materials_specular material specularFactor=num(0,1) specularTexture=obj.textureInfo specularColorFactor=nums:3(0) specularColorTexture=obj.textureInfo
@KHR_materials_clearcoat material clearcoatFactor=num(0,1) clearcoatTexture=obj.textureInfo clearcoatRoughnessFactor=num(0,1) clearcoatRoughnessTexture=obj.textureInfo clearcoatNormalTexture=obj.normalTextureInfo
@KHR_materials_emissive_strength material emissiveStrength=num(0)
@KHR_materials_unlit material
@KHR_materials_dispersion material dispersion=num(0)
@KHR_materials_pbrSpecularGlossiness material diffuseFactor=nums:4(0,1) diffuseTexture=obj.textureInfo specularFactor=nums:3(0,1) glossinessFactor=num(0,1) specularGlossinessTexture=obj.textureInfo
@KHR_materials_sheen material sheenColorFactor=nums:3(0,1) sheenColorTexture=obj.textureInfo sheenRoughnessFactor=num(0,1) sheenRoughnessTexture=obj.textureInfo
@KHR_materials_transmission material transmissionFactor=num(0,1) transmissionTexture=obj.textureInfo
@KHR_materials_volume material thicknessFactor=num(0) thicknessTexture=obj.textureInfo attenuationDistance=num(>0) attenuationColor=nums:3(0,1)
@KHR_materials_anisotropy material anisotropyStrength=num(0,1) anisotropyRotation=num anisotropyTexture=obj.textureInfo
@KHR_materials_iridescence material iridescenceFactor=num(0,1) iridescenceTexture=obj.textureInfo iridescenceIor=num(1) iridescenceThicknessMinimum=num(0) iridescenceThicknessMaximum=num(0) iridescenceThicknessTexture=obj.textureInfo
@KHR_lights_punctual root lights!=list.light
@KHR_lights_punctual node light!=id.lights
@KHR_materials_variants root variants!=list.variant
@KHR_materials_variants primitive mappings!=list.variantMapping
@KHR_animation_pointer target pointer!=str
@AGI_articulations root articulations=list.articulation
@AGI_articulations node articulationName=str isAttachPoint=bool
)";

}  // namespace panwright::importers::gltf
