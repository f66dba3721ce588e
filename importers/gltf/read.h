// Numbers of accessors. Private to importers/gltf.
#pragma once

#include <cstdint>
#include <vector>

#include "importers/gltf/document.h"

namespace panwright::importers::gltf {

// Reads elements as vectors of N numbers; those that the accessor has fewer of are 0, more are
// skipped. Normalised integers become −1 to 1. Sparse values are laid over.
//
//   object   the JSON pointer that problems name
//   returns  empty when the accessor is not sound or its zeros are over a limit
//
// Reports E6207 for numbers that are not finite; they become 0. Instances: Vec2, Vec3, Vec4, Mat4.
template <class Vector>
std::vector<Vector> read_vectors(Document& document, std::size_t accessor,
                                 const std::string& object);

// Reads unsigned integers.
std::vector<std::uint32_t> read_indices(Document& document, std::size_t accessor,
                                        const std::string& object);

// The elements that the values of a sparse accessor are for. Expects: a.is_sparse.
std::vector<std::uint32_t> sparse_places(const Document& document, const Accessor& a);

// How many numbers of an accessor are not finite, sparse values laid over. 0 where it is not sound
// or holds integers.
std::size_t count_not_finite(const Document& document, const Accessor& a);

// Whether elements that no view holds may be allocated: what a file leaves out may be at most 64
// times as long as the file, and 1 MiB.
bool may_invent(Document& document, std::uint64_t bytes, const std::string& object);

// The factor of a normalised integer; 1 of others.
double scale_of(int component, bool normalised);

}  // namespace panwright::importers::gltf
