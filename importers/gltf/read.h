// Numbers of accessors. Private to importers/gltf.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "importers/gltf/document.h"

namespace panwright::importers::gltf {

// Reads elements as vectors of N numbers; missing ones are 0, surplus ones skipped. Normalised
// integers become −1 to 1. Applies sparse values.
//
//   object   the JSON pointer for diagnostics
//   returns  empty if the accessor is invalid or its zeros exceed a limit
//
// Reports E6207 for numbers that are not finite; they become 0. Instances: Vec2, Vec3, Vec4, Mat4.
template <class Vector>
std::vector<Vector> read_vectors(Document& document, std::size_t accessor,
                                 const std::string& object);

// Reads the elements at `places`, which are below the accessor's count. Numbers that are not finite
// become 0, unreported. Cost: O(places); of sparse accessors O(count). Instances: Vec2, Vec3, Vec4.
template <class Vector>
std::vector<Vector> read_vectors_at(Document& document, std::size_t accessor,
                                    std::span<const std::uint32_t> places,
                                    const std::string& object);

// Reads unsigned integers.
std::vector<std::uint32_t> read_indices(Document& document, std::size_t accessor,
                                        const std::string& object);

// Returns the elements addressed by a sparse accessor. Expects: a.is_sparse.
std::vector<std::uint32_t> sparse_places(const Document& document, const Accessor& a);

// Counts numbers of an accessor that are not finite, sparse values applied. 0 if it is invalid or
// holds integers.
std::size_t count_not_finite(const Document& document, const Accessor& a);

// Returns true if elements without a view may be allocated: at most 64 times the file, and 1 MiB.
bool may_invent(Document& document, std::uint64_t bytes, const std::string& object);

// Returns the factor of a normalised integer; 1 of others.
double scale_of(int component, bool normalised);

}  // namespace panwright::importers::gltf
