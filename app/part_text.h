#pragma once
/// A part file for people and for machines, as `tactum prepare` and `tactum inspect` print it.

#include <nlohmann/json.hpp>
#include <string>

#include "tactum/mesh/part_file.h"

namespace tactum {

/// What to say first when the unit was guessed and may be another, with the command that says which it is;
/// empty when it is certain. `prepare` is that command up to its options.
std::string unit_warning(const std::string& prepare, const PartFile& file);

/// Lines of text: unit, repair, pieces, mass, verification.
std::string describe_part(const std::string& path, const PartFile& file);

/// The report kept in the file, with the file's name and size.
nlohmann::ordered_json part_json(const std::string& path, const PartFile& file);

}  // namespace tactum
