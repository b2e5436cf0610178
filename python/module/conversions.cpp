#include "conversions.h"

#include <algorithm>

namespace tactum::python {

std::string shape_of(const Array& array) {
  std::string text = "(";
  for (py::ssize_t i = 0; i < array.ndim(); ++i)
    text += std::to_string(array.shape(i)) + (i + 1 < array.ndim() || array.ndim() == 1 ? ", " : "");
  return text + ")";
}

Pose pose_of(const Array& X, const char* name) {
  if (X.ndim() != 2 || X.shape(0) != 4 || X.shape(1) != 4)
    throw Refusal({"a pose has another shape", shape_of(X), "(4, 4), a homogeneous matrix", name});
  const double* numbers = X.data();
  Pose out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out.R(i, j) = numbers[4 * i + j];
    out.p[i] = numbers[4 * i + 3];
  }
  return out;
}

Vec3 vector_of(const Array& v, const char* name) {
  if (v.ndim() != 1 || v.shape(0) != 3)
    throw Refusal({"a vector has another shape", shape_of(v), "(3,)", name});
  return {v.data()[0], v.data()[1], v.data()[2]};
}

Wrench wrench_of(const Array& F, const char* name) {
  if (F.ndim() != 1 || F.shape(0) != 6)
    throw Refusal({"a wrench has another shape", shape_of(F), "(6,): force, torque", name});
  const double* n = F.data();
  return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
}

void put(const Wrench& F, double* out) noexcept {
  std::copy_n(F.f.data(), 3, out);
  std::copy_n(F.t.data(), 3, out + 3);
}

void put(const Pose& X, double* out) noexcept {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out[4 * i + j] = X.R(i, j);
    out[4 * i + 3] = X.p[i];
    out[12 + i] = 0.0;
  }
  out[15] = 1.0;
}

Array array_of(const Pose& X) {
  Array out({4, 4});
  put(X, out.mutable_data());
  return out;
}

Array array_of(const Vec3& v) {
  Array out(3);
  std::copy_n(v.data(), 3, out.mutable_data());
  return out;
}

Array array_of(const Mat3& M) {
  Array out({3, 3});
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out.mutable_data()[3 * i + j] = M(i, j);
  return out;
}

Array array_of(const Wrench& F) {
  Array out(6);
  put(F, out.mutable_data());
  return out;
}

}  // namespace tactum::python
