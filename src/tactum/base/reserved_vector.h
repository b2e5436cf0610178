#pragma once
/// A vector whose copy keeps its capacity. Frames fill the room that was reserved at load time without
/// allocating; a copied std::vector has room for its present items only, so that a copied state would drop
/// later ones.

#include <vector>

namespace tactum::inline v0_1 {

template <class T>
class ReservedVector : public std::vector<T> {
 public:
  using std::vector<T>::vector;
  ReservedVector() = default;
  ReservedVector(const ReservedVector& other) : std::vector<T>() { *this = other; }
  ReservedVector(ReservedVector&&) noexcept = default;
  ReservedVector& operator=(const ReservedVector& other) {
    this->reserve(other.capacity());
    this->assign(other.begin(), other.end());
    return *this;
  }
  ReservedVector& operator=(ReservedVector&&) noexcept = default;
  ~ReservedVector() = default;
};

}  // namespace tactum::inline v0_1
