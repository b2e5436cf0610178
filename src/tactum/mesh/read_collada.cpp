#include <tinyxml2.h>

#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "tactum/mesh/mesh_builder.h"
#include "tactum/mesh/text_scanner.h"

/// COLLADA 1.4 and 1.5: the meshes of the scene, each as often as it stands in it, in metres and with z up,
/// as the file's <unit> and <up_axis> have it. Everything that is not geometry is passed over: materials,
/// cameras, lights, animations. A mesh on a skeleton is left out, which is told.
///
///   <scene> -> <visual_scene> -> <node>, in each other, with their transforms
///           -> <instance_geometry> -> <mesh> -> <triangles> and its kin -> <vertices> -> <source>

namespace tactum::inline v0_1::detail {
namespace {

using XmlNode = tinyxml2::XMLElement;

constexpr int kDeepestNode = 256;      // nodes may refer to nodes, also to those they stand in
constexpr int kMostNodes = 1'000'000;  // ... and so become many of few
constexpr int kMaxCornersAt = 64;      // numbers for each corner of a face: position, normal, ...

/// Linear part and displacement; node transforms may scale, each axis its own.
struct Affine {
  Mat3 A = Mat3::Identity();
  Vec3 p = Vec3::Zero();
};
Affine operator*(const Affine& a, const Affine& b) { return {a.A * b.A, a.A * b.p + a.p}; }

const char* attribute_in(const XmlNode& element, const char* name) {
  const char* value = element.Attribute(name);
  return value == nullptr ? "" : value;
}
std::string_view text_in(const XmlNode& element) {
  const char* text = element.GetText();
  return text == nullptr ? std::string_view() : text;
}
bool has_name(const XmlNode& element, const char* name) { return std::string_view(element.Name()) == name; }
std::string line_of(const XmlNode& element) { return at_line(element.GetLineNum()); }

class ColladaReader {
 public:
  explicit ColladaReader(MeshBuilder& builder) : builder_(builder) {}

  Result<void> read(std::string_view text) {
    if (document_.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
      return builder_.error("the text is no XML", "", "well-formed XML", at_line(document_.ErrorLineNum()));
    const XmlNode* root = document_.RootElement();
    if (root == nullptr || !has_name(*root, "COLLADA"))
      return builder_.error("this is no COLLADA", root == nullptr ? "" : in_quotes(root->Name()),
                            "<COLLADA> as its root");
    if (Result<void> known = index(*root); !known) return known;
    const Result<Affine> X = file_to_metres(*root);
    if (!X) return X.error();
    const XmlNode* instance = nullptr;
    if (const XmlNode* scene = root->FirstChildElement("scene"))
      instance = scene->FirstChildElement("instance_visual_scene");
    if (instance == nullptr)
      return builder_.error("the file shows nothing", "no <instance_visual_scene> in <scene>", "one",
                            line_of(*root));
    const Result<const XmlNode*> shown = referred(*instance, "url", "visual_scene");
    if (!shown) return shown.error();
    Result<void> done = read_nodes(**shown, *X, 0);
    if (skinned_ > 0)
      builder_.report().remarks.push_back(
          std::to_string(skinned_) +
          (skinned_ == 1 ? " mesh on a skeleton was left out." : " meshes on a skeleton were left out."));
    return done;
  }

 private:
  Error wrong(const XmlNode& element, const std::string& what, const std::string& found,
              const std::string& expected) const {
    return builder_.error(what, found, expected, line_of(element));
  }

  /// Keeps every element that has an id.
  Result<void> index(const XmlNode& root) {
    for (const XmlNode* at = &root; at != nullptr;) {
      if (const char* id = at->Attribute("id"))
        if (!by_id_.emplace(id, at).second)
          return wrong(*at, "two elements have one id", in_quotes(id), "another");
      if (const XmlNode* below = at->FirstChildElement()) {
        at = below;
        continue;
      }
      while (at != &root && at->NextSiblingElement() == nullptr) at = at->Parent()->ToElement();
      at = at == &root ? nullptr : at->NextSiblingElement();
    }
    return {};
  }

  /// The element of this name that an attribute refers to, as "#id".
  Result<const XmlNode*> referred(const XmlNode& from, const char* attribute, const char* name) const {
    const std::string_view url = attribute_in(from, attribute);
    const auto found = url.starts_with('#') ? by_id_.find(std::string(url.substr(1))) : by_id_.end();
    if (found == by_id_.end() || !has_name(*found->second, name))
      return wrong(from, "the file refers to something that is not in it", in_quotes(url),
                   std::string("#ID of a <") + name + ">");
    return found->second;
  }

  Result<std::vector<double>> numbers_of(const XmlNode& element) const {
    std::vector<double> numbers;
    WordReader words(text_in(element), element.GetLineNum());
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      double number = 0.0;
      if (!parse_number(word, number))
        return builder_.error("this is no number", in_quotes(word), "a number", at_line(words.line_number()));
      numbers.push_back(number);
    }
    return numbers;
  }

  Result<std::vector<int>> integers_of(const XmlNode& element) const {
    std::vector<int> numbers;
    WordReader words(text_in(element), element.GetLineNum());
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      int number = 0;
      if (!parse_number(word, number) || number < 0)
        return builder_.error("this is no index", in_quotes(word), "a whole number from 0",
                              at_line(words.line_number()));
      numbers.push_back(number);
    }
    return numbers;
  }

  /// An attribute that counts something, or `otherwise` where there is none.
  Result<int> count_of(const XmlNode& element, const char* name, int otherwise, int least, int most) const {
    const char* word = element.Attribute(name);
    int number = otherwise;
    if (word != nullptr && (!parse_number(std::string_view(word), number) || number < least || number > most))
      return wrong(element, std::string("the attribute ") + name + " is wrong", in_quotes(word),
                   std::to_string(least) + " to " + std::to_string(most));
    return number;
  }

  /// From the numbers of the file to metres with z up.
  Result<Affine> file_to_metres(const XmlNode& root) {
    Affine X;
    const XmlNode* asset = root.FirstChildElement("asset");
    if (asset == nullptr) return Affine{axes_of("Y_UP"), Vec3::Zero()};
    const XmlNode* axis = asset->FirstChildElement("up_axis");
    const std::string up(axis == nullptr ? "Y_UP" : Tokens(text_in(*axis)).next());
    if (up != "X_UP" && up != "Y_UP" && up != "Z_UP")
      return wrong(*axis, "the axis that is up is not known", in_quotes(up), "X_UP, Y_UP or Z_UP");
    X.A = axes_of(up);
    if (up != "Z_UP")
      builder_.report().remarks.push_back("The file has " + up.substr(0, 1) + " up; here z is.");
    const XmlNode* unit = asset->FirstChildElement("unit");
    const char* metres = unit == nullptr ? nullptr : unit->Attribute("meter");
    if (metres == nullptr) return X;
    double scale = 0.0;
    if (!parse_number(std::string_view(metres), scale) || !std::isfinite(scale) || scale <= 0.0)
      return wrong(*unit, "the unit is no length", in_quotes(metres), "metres above zero");
    if (scale != 1.0)
      builder_.report().remarks.push_back(std::string("A unit of the file is ") + metres + " m.");
    X.A *= scale;
    return X;
  }

  /// The axes of the file in those with z up: right, up and out of the screen as the standard names them.
  static Mat3 axes_of(std::string_view up) {
    Mat3 R = Mat3::Identity();
    if (up == "X_UP") R << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    if (up == "Y_UP") R << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    return R;
  }

  /// What one element of a node does to all that stands in the node; none where it is no transform.
  Result<std::optional<Affine>> transform_of(const XmlNode& element) const {
    const std::string_view name = element.Name();
    const std::size_t wanted = name == "matrix" ? 16 : name == "rotate" ? 4 : 3;
    if (name == "lookat" || name == "skew")
      return wrong(element, "this transform is not read", "<" + std::string(name) + ">",
                   "matrix, translate, rotate or scale");
    if (name != "matrix" && name != "translate" && name != "rotate" && name != "scale")
      return std::optional<Affine>();
    const Result<std::vector<double>> numbers = numbers_of(element);
    if (!numbers) return numbers.error();
    const std::vector<double>& n = *numbers;
    if (n.size() != wanted)
      return wrong(element, "a <" + std::string(name) + "> has another number of numbers",
                   std::to_string(n.size()), std::to_string(wanted));
    Affine X;
    if (name == "matrix") {
      X.A << n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10];
      X.p = Vec3(n[3], n[7], n[11]);
    } else if (name == "translate") {
      X.p = Vec3(n[0], n[1], n[2]);
    } else if (name == "scale") {
      X.A = Vec3(n[0], n[1], n[2]).asDiagonal();
    } else {
      const Vec3 axis(n[0], n[1], n[2]);
      if (!(axis.norm() > 0.0)) return wrong(element, "an axis of length zero", "0 0 0", "any other");
      X.A = Eigen::AngleAxisd(n[3] * std::numbers::pi / 180.0, axis.normalized()).toRotationMatrix();
    }
    return std::optional<Affine>(X);
  }

  /// The nodes that stand in an element, or that it refers to, and their meshes.
  Result<void> read_nodes(const XmlNode& parent, const Affine& X, int depth) {
    for (const XmlNode* child = parent.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      Result<void> done;
      if (has_name(*child, "node")) {
        done = read_node(*child, X, depth + 1);
      } else if (has_name(*child, "instance_node")) {
        const Result<const XmlNode*> node = referred(*child, "url", "node");
        if (!node) return node.error();
        done = read_node(**node, X, depth + 1);
      } else if (has_name(*child, "instance_geometry")) {
        const Result<const XmlNode*> geometry = referred(*child, "url", "geometry");
        if (!geometry) return geometry.error();
        done = read_geometry(**geometry, X);
      } else if (has_name(*child, "instance_controller")) {
        ++skinned_;
      }
      if (!done) return done;
    }
    return {};
  }

  Result<void> read_node(const XmlNode& node, const Affine& X_parent, int depth) {
    if (depth > kDeepestNode || ++nodes_ > kMostNodes)
      return wrong(node, "there are too many nodes, or nodes that stand in themselves",
                   depth > kDeepestNode ? "nodes " + std::to_string(depth) + " deep" : std::to_string(nodes_),
                   "at most " + std::to_string(kMostNodes) + ", " + std::to_string(kDeepestNode) + " deep");
    Affine X = X_parent;
    for (const XmlNode* child = node.FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement()) {
      const Result<std::optional<Affine>> step = transform_of(*child);
      if (!step) return step.error();
      if (*step) X = X * **step;
    }
    return read_nodes(node, X, depth);
  }

  /// The points of a <vertices>.
  Result<std::vector<Vec3>> positions_of(const XmlNode& vertices) const {
    for (const XmlNode* input = vertices.FirstChildElement("input"); input != nullptr;
         input = input->NextSiblingElement("input")) {
      if (std::string_view(attribute_in(*input, "semantic")) != "POSITION") continue;
      const Result<const XmlNode*> source = referred(*input, "source", "source");
      if (!source) return source.error();
      return points_of(**source);
    }
    return wrong(vertices, "the vertices have no positions", "no <input semantic=\"POSITION\">", "one");
  }

  /// The triples of numbers of a <source>, as its <accessor> picks them out of their array.
  Result<std::vector<Vec3>> points_of(const XmlNode& source) const {
    const XmlNode* technique = source.FirstChildElement("technique_common");
    const XmlNode* accessor = technique == nullptr ? nullptr : technique->FirstChildElement("accessor");
    if (accessor == nullptr) return wrong(source, "a source says not how it is read", "no <accessor>", "one");
    const Result<const XmlNode*> array = referred(*accessor, "source", "float_array");
    if (!array) return array.error();
    const Result<std::vector<double>> numbers = numbers_of(**array);
    if (!numbers) return numbers.error();
    const int most = static_cast<int>(std::min<std::size_t>(numbers->size(), 1u << 30));
    const Result<int> stride = count_of(*accessor, "stride", 1, 3, std::max(3, most));
    if (!stride) return stride.error();
    const Result<int> offset = count_of(*accessor, "offset", 0, 0, most);
    if (!offset) return offset.error();
    const Result<int> count = count_of(*accessor, "count", 0, 0, (most - *offset) / *stride);
    if (!count) return count.error();
    std::vector<Vec3> points;
    points.reserve(static_cast<std::size_t>(*count));
    for (int i = 0; i < *count; ++i) {
      const double* n = numbers->data() + *offset + static_cast<std::ptrdiff_t>(i) * *stride;
      points.emplace_back(n[0], n[1], n[2]);
    }
    return points;
  }

  Result<void> read_geometry(const XmlNode& geometry, const Affine& X) {
    const XmlNode* mesh = geometry.FirstChildElement("mesh");
    if (mesh == nullptr) {
      builder_.report().remarks.push_back("The geometry " + in_quotes(attribute_in(geometry, "id")) +
                                          " is no mesh and was left out.");
      return {};
    }
    const XmlNode* vertices = mesh->FirstChildElement("vertices");
    if (vertices == nullptr) return wrong(*mesh, "a mesh has no vertices", "no <vertices>", "one");
    const Result<std::vector<Vec3>> points = positions_of(*vertices);
    if (!points) return points.error();
    const char* name = geometry.Attribute("name");
    builder_.begin_group(name == nullptr ? attribute_in(geometry, "id") : name);
    first_vertex_ = builder_.vertex_count();
    for (const Vec3& point : *points)
      if (Result<void> done = builder_.add_vertex(X.A * point + X.p, line_of(*vertices)); !done) return done;
    mirrored_ = X.A.determinant() < 0.0;
    vertices_id_ = attribute_in(*vertices, "id");
    for (const XmlNode* child = mesh->FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement())
      if (Result<void> done = read_primitive(*child); !done) return done;
    return {};
  }

  /// A kind of faces of a mesh; anything else that stands there is passed over.
  Result<void> read_primitive(const XmlNode& primitive) {
    const std::string_view name = primitive.Name();
    if (name == "lines" || name == "linestrips") ++builder_.report().lines_dropped;
    if (name != "triangles" && name != "polylist" && name != "polygons" && name != "tristrips" &&
        name != "trifans")
      return {};
    if (const XmlNode* holes = primitive.FirstChildElement("ph"))
      return wrong(*holes, "polygons with holes are not read", "<ph>", "polygons without holes");
    std::vector<int> counts;
    if (const XmlNode* listed = primitive.FirstChildElement("vcount")) {
      const Result<std::vector<int>> read = integers_of(*listed);
      if (!read) return read.error();
      counts = *read;
    }
    for (const XmlNode* p = primitive.FirstChildElement("p"); p != nullptr; p = p->NextSiblingElement("p")) {
      const Result<std::vector<int>> corners = corners_of(primitive, *p);
      if (!corners) return corners.error();
      Result<void> done = name == "polylist"    ? add_polygons(*p, *corners, counts)
                          : name == "polygons"  ? add_face(*p, *corners)
                          : name == "triangles" ? add_triangles(*p, *corners)
                                                : add_strip(*p, *corners, name == "trifans");
      if (!done) return done;
    }
    return {};
  }

  /// Picks the vertices out of the numbers of a <p>, which has several for each corner.
  Result<std::vector<int>> corners_of(const XmlNode& primitive, const XmlNode& p) const {
    int width = 1, at = -1;
    for (const XmlNode* input = primitive.FirstChildElement("input"); input != nullptr;
         input = input->NextSiblingElement("input")) {
      const Result<int> offset = count_of(*input, "offset", 0, 0, kMaxCornersAt - 1);
      if (!offset) return offset.error();
      width = std::max(width, *offset + 1);
      if (std::string_view(attribute_in(*input, "semantic")) != "VERTEX") continue;
      if (attribute_in(*input, "source") != "#" + vertices_id_)
        return wrong(*input, "faces are of other vertices than their mesh",
                     in_quotes(attribute_in(*input, "source")), "#" + vertices_id_);
      at = *offset;
    }
    if (at < 0) return wrong(primitive, "faces have no vertices", "no <input semantic=\"VERTEX\">", "one");
    const Result<std::vector<int>> numbers = integers_of(p);
    if (!numbers) return numbers.error();
    if (numbers->size() % static_cast<std::size_t>(width) != 0)
      return wrong(p, "the corners of faces are not whole", std::to_string(numbers->size()) + " numbers",
                   "a multiple of " + std::to_string(width));
    std::vector<int> corners;
    const int most = builder_.vertex_count() - first_vertex_;
    for (std::size_t i = static_cast<std::size_t>(at); i < numbers->size();
         i += static_cast<std::size_t>(width)) {
      const int vertex = (*numbers)[i];
      if (vertex >= most)
        return wrong(p, "a face refers to a vertex that is not there", std::to_string(vertex) + " (from 0)",
                     "less than " + std::to_string(most));
      corners.push_back(first_vertex_ + vertex);
    }
    return corners;
  }

  Result<void> add_face(const XmlNode& p, std::vector<int> corners) {
    if (mirrored_) corners = {corners.rbegin(), corners.rend()};
    return builder_.add_polygon(corners, line_of(p));
  }

  Result<void> add_triangles(const XmlNode& p, const std::vector<int>& corners) {
    if (corners.size() % 3 != 0)
      return wrong(p, "triangles are not whole", std::to_string(corners.size()) + " corners",
                   "a multiple of 3");
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
      if (Result<void> done = add_face(p, {corners[i], corners[i + 1], corners[i + 2]}); !done) return done;
    return {};
  }

  Result<void> add_polygons(const XmlNode& p, const std::vector<int>& corners,
                            const std::vector<int>& counts) {
    auto from = corners.begin();
    for (const int count : counts) {
      if (corners.end() - from < count)
        return wrong(p, "there are less corners than <vcount> says", std::to_string(corners.size()), "more");
      if (Result<void> done = add_face(p, {from, from + count}); !done) return done;
      from += count;
    }
    if (from == corners.end()) return {};
    return wrong(p, "there are more corners than <vcount> says", std::to_string(corners.size()),
                 std::to_string(from - corners.begin()));
  }

  /// Triangles that share an edge each with the last one; of a strip, every second is turned round.
  Result<void> add_strip(const XmlNode& p, const std::vector<int>& corners, bool is_fan) {
    for (std::size_t i = 2; i < corners.size(); ++i) {
      const int a = corners[is_fan ? 0 : i - 2], b = corners[i - 1];
      const bool turned = !is_fan && i % 2 == 1;
      Result<void> done = turned ? add_face(p, {b, a, corners[i]}) : add_face(p, {a, b, corners[i]});
      if (!done) return done;
    }
    return {};
  }

  MeshBuilder& builder_;
  tinyxml2::XMLDocument document_;
  std::map<std::string, const XmlNode*> by_id_;
  std::string vertices_id_;  // of the mesh that is read
  int first_vertex_ = 0;     // its first vertex
  bool mirrored_ = false;    // it is turned inside out where it stands
  int nodes_ = 0, skinned_ = 0;
};

}  // namespace

Result<void> read_collada(std::string_view text, MeshBuilder& builder) {
  builder.report().format = "COLLADA";
  builder.report().in_metres = true;
  return ColladaReader(builder).read(text);
}

}  // namespace tactum::inline v0_1::detail
