#pragma once
/// The errors and notes of a file that is imported, and its attributes as values.

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tactum/import/xml_tree.h"
#include "tactum/math/pose.h"
#include "tactum/scene/item_errors.h"

namespace tactum::inline v0_1 {

/// What the scene does not have of the file, or has in another way.
struct ImportNote {
  std::string file = {};
  int line = 0;           ///< counted from 1
  std::string text = {};  ///< a clause

  /// "FILE:LINE: TEXT".
  std::string sentence() const;
};

/// The first error and all notes.
class ImportLog {
 public:
  const FirstError& errors() const { return errors_; }
  /// The notes by file and line.
  std::vector<ImportNote> notes() const;

  void fail(const XmlElement& at, std::string what, std::string found = "", std::string expected = "");
  void fail(const XmlElement& at, const XmlAttribute& attribute, std::string what, std::string found,
            std::string expected);
  void note(const XmlElement& at, std::string text);
  /// Notes every element and attribute inside that no reader has looked at; of an element that nobody read
  /// not what it holds.
  void note_unread(const XmlElement& element);

 private:
  FirstError errors_;
  std::vector<ImportNote> notes_;
};

/// The attributes of an element, and where it has none of a name those of the elements that stand behind
/// it, the defaults of MJCF.
class Attributes {
 public:
  Attributes(ImportLog& log, const XmlElement& element, const std::vector<const XmlElement*>& defaults = {});

  ImportLog& log() const { return log_; }
  const XmlElement& element() const { return *layers_.front(); }
  const std::vector<const XmlElement*>& layers() const { return layers_; }

  bool has(std::string_view name) const;
  std::string text(std::string_view name, const std::string& fallback = "") const;
  double number(std::string_view name, double fallback, Range range = kAny) const;
  bool flag(std::string_view name, bool fallback) const;
  /// The index of one of the words.
  int word(std::string_view name, int fallback, const std::vector<std::string>& words) const;
  Vec3 vector(std::string_view name, const Vec3& fallback) const;
  /// So many numbers at least and at most; an absent attribute gives none.
  std::vector<double> numbers(std::string_view name, std::size_t least, std::size_t most) const;
  /// Numbers of which each layer may give the first few: those of the farther ones, and over them the nearer.
  void overlay(std::string_view name, std::vector<double>& values) const;
  /// An error at the attribute, or at the element without it.
  void fail(std::string_view name, std::string what, std::string found, std::string expected) const;

 private:
  struct Found {
    const XmlElement* element = nullptr;
    const XmlAttribute* attribute = nullptr;
  };
  Found find(std::string_view name) const;
  std::vector<double> parsed(const Found& found, std::size_t least, std::size_t most) const;

  ImportLog& log_;
  std::vector<const XmlElement*> layers_;
};

}  // namespace tactum::inline v0_1
