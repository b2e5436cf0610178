#pragma once
/// The elements of an XML file with their lines, and a mark on everything that a reader has looked at: what
/// is left without a mark was not honoured, and is told (import_log.h).

#include <string>
#include <string_view>
#include <vector>

#include "tactum/base/result.h"

namespace tactum::inline v0_1 {

struct XmlAttribute {
  std::string name = {};
  std::string value = {};
  int line = 0;               ///< counted from 1
  mutable bool read = false;  ///< a reader has looked at it
};

struct XmlElement {
  std::string name = {};
  std::string file = {};  ///< as errors call it
  int line = 0;           ///< of its opening bracket, counted from 1
  std::vector<XmlAttribute> attributes = {};
  std::vector<XmlElement> children = {};
  mutable bool read = false;  ///< a reader has looked at it

  /// The attribute, now marked as read; null when there is none.
  const XmlAttribute* find(std::string_view attribute) const;
  /// The first child of this name, now marked as read; null when there is none.
  const XmlElement* child(std::string_view element) const;
  /// The children of this name, now marked as read.
  std::vector<const XmlElement*> all(std::string_view element) const;
};

/// "FILE:LINE".
std::string place_of(const XmlElement& element);
std::string place_of(const XmlElement& element, const XmlAttribute& attribute);

/// The root element of a text. An error names the line where it is no XML, has a second root, an attribute
/// twice, or elements more than 500 deep. Linear in the text but for that last.
Result<XmlElement> parse_xml(std::string_view text, const std::string& file);

/// The same of a file of at most 64 MB, which errors call by its path.
Result<XmlElement> read_xml_file(const std::string& path);

}  // namespace tactum::inline v0_1
