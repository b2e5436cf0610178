#pragma once
/// Between numpy and the library: poses as 4 x 4 matrices, wrenches as six numbers, errors as exceptions.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <stdexcept>
#include <string>
#include <utility>

#include "tactum/base/result.h"
#include "tactum/math/spatial.h"

namespace tactum::python {

namespace py = pybind11;

/// What becomes tactum.Error in Python.
class Refusal final : public std::runtime_error {
 public:
  explicit Refusal(const Error& error) : std::runtime_error(error.message()) {}
};

/// The value, or an exception with the same sentence.
template <class T>
T or_raise(Result<T> result) {
  if (!result) throw Refusal(result.error());
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

/// An array of doubles, converted where it is none.
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// "(4, 4)", of any array.
std::string shape_of(const Array& array);
/// The pose of a 4 x 4 matrix; its rotation is taken as it is, to the bit.
Pose pose_of(const Array& X, const char* name);
Vec3 vector_of(const Array& v, const char* name);
Wrench wrench_of(const Array& F, const char* name);

Array array_of(const Pose& X);
Array array_of(const Vec3& v);
Array array_of(const Mat3& M);
/// Force, then torque.
Array array_of(const Wrench& F);
void put(const Wrench& F, double* out) noexcept;
void put(const Pose& X, double* out) noexcept;

// What the module has, each in a file of its own.
void bind_parts(py::module_& module);
void bind_simulations(py::module_& module);
void bind_worlds(py::module_& module);
void bind_sessions(py::module_& module);
void bind_recordings(py::module_& module);

}  // namespace tactum::python
