#include "tactum/import/xml_tree.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <filesystem>
#include <fstream>

#include "tactum/base/text_encoding.h"

namespace tactum::inline v0_1 {
namespace {

constexpr std::uintmax_t kMostXmlBytes = 64ull << 20;

std::string file_and_line(const std::string& file, int line) { return fmt::format("{}:{}", file, line); }

/// In the words of a person; tinyxml2 names its errors for programs.
const char* fault_of(tinyxml2::XMLError error) {
  switch (error) {
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT:
      return "the file has no element";
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "an element ends with another name than it began with, or does not end";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "an attribute is not name=\"value\", or stands twice";
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED:
      return "elements stand too deep in each other";
    default:
      return "the text is no XML";
  }
}

/// A copy of an element that tinyxml2 has read, which is at most 500 deep.
XmlElement copied(const tinyxml2::XMLElement& from, const std::string& file) {
  XmlElement element{.name = from.Name(), .file = file, .line = from.GetLineNum()};
  for (const auto* attribute = from.FirstAttribute(); attribute != nullptr; attribute = attribute->Next())
    element.attributes.push_back(
        {.name = attribute->Name(), .value = attribute->Value(), .line = attribute->GetLineNum()});
  for (const auto* child = from.FirstChildElement(); child != nullptr; child = child->NextSiblingElement())
    element.children.push_back(copied(*child, file));
  return element;
}

}  // namespace

const XmlAttribute* XmlElement::find(std::string_view attribute) const {
  for (const XmlAttribute& candidate : attributes)
    if (candidate.name == attribute) {
      candidate.read = true;
      return &candidate;
    }
  return nullptr;
}

const XmlElement* XmlElement::child(std::string_view element) const {
  for (const XmlElement& candidate : children)
    if (candidate.name == element) {
      candidate.read = true;
      return &candidate;
    }
  return nullptr;
}

std::vector<const XmlElement*> XmlElement::all(std::string_view element) const {
  std::vector<const XmlElement*> found;
  for (const XmlElement& candidate : children) {
    if (candidate.name != element) continue;
    candidate.read = true;
    found.push_back(&candidate);
  }
  return found;
}

std::string place_of(const XmlElement& element) { return file_and_line(element.file, element.line); }

std::string place_of(const XmlElement& element, const XmlAttribute& attribute) {
  return file_and_line(element.file, attribute.line);
}

Result<XmlElement> parse_xml(std::string_view text, const std::string& file) {
  const Result<std::string_view> plain = utf8_text(text, file);
  if (!plain) return plain.error();
  tinyxml2::XMLDocument document;
  if (document.Parse(plain->data(), plain->size()) != tinyxml2::XML_SUCCESS)
    return Error{fault_of(document.ErrorID()), "", "well-formed XML",
                 file_and_line(file, document.ErrorLineNum())};
  const tinyxml2::XMLElement* root = document.RootElement();
  if (root == nullptr)
    return Error{"the file has no element", "", "<robot> or <mujoco>", file_and_line(file, 1)};
  if (const tinyxml2::XMLElement* second = root->NextSiblingElement())
    return Error{"the file has a second root element", fmt::format("<{}>", second->Name()), "one",
                 file_and_line(file, second->GetLineNum())};
  return copied(*root, file);
}

Result<XmlElement> read_xml_file(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code failure;
  if (!fs::is_regular_file(path, failure))
    return Error{"cannot read the file", fs::is_directory(path, failure) ? "a folder" : "no such file",
                 "an XML file", path};
  const std::uintmax_t size = fs::file_size(path, failure);
  if (failure || size > kMostXmlBytes)
    return Error{"cannot read the file", failure ? failure.message() : "more than 64 MB", "an XML file",
                 path};
  std::string text(size, '\0');
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(text.data(), static_cast<std::streamsize>(size)))
    return Error{"cannot read the file", "a read error", "a readable file", path};
  return parse_xml(text, path);
}

}  // namespace tactum::inline v0_1
