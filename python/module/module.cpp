/// The module tactum._tactum; python/tactum/__init__.py is what a program imports.

#include "conversions.h"
#include "tactum/version.h"

PYBIND11_MODULE(_tactum, module) {
  using namespace tactum;
  namespace py = pybind11;
  module.attr("version") = py::make_tuple(TACTUM_VERSION_MAJOR, TACTUM_VERSION_MINOR, TACTUM_VERSION_PATCH);
  py::register_exception<python::Refusal>(module, "Error", PyExc_ValueError).doc() =
      "What was found, what was expected, and where: the sentence of the program.";
  python::bind_parts(module);
  python::bind_worlds(module);
  python::bind_simulations(module);
  python::bind_sessions(module);
  python::bind_recordings(module);
}
