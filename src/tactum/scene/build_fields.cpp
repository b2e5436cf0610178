#include <fmt/format.h>

#include "tactum/scene/field_file.h"
#include "tactum/scene/scene_builder.h"

namespace tactum::inline v0_1 {
namespace {

/// Sample points of a body that has none, in a scene with fields.
constexpr int kFieldPoints = 100;
/// A scene file of a hundred bytes must not ask for more memory than this many nodes take: 0.8 GB in doubles.
constexpr std::size_t kMostSampledNodes = std::size_t{1} << 25;

template <class Number, class Formula>
FieldGrid::Samples samples_of(const Formula& formula, const GridShape& shape) {
  return sampled<Number>(shape, [&](const Vec3& p) { return value_at(formula, p).force; });
}

/// Makes the shape of a field; its table is at `path`.
class FieldMaker {
 public:
  FieldMaker(SceneBuilder& builder, const std::string& path, double edge_m)
      : builder_(builder), path_(path), edge_m_(edge_m) {}

  using Made = decltype(ForceField::shape);

  template <class Described>
  Made operator()(const Described& field) const {
    return field.sampled ? sampled_grid(field.formula, *field.sampled) : Made(field.formula);
  }

  Made operator()(const GridDescription& field) const {
    const std::string item = item_path(path_, "file");
    const std::optional<std::string> found = builder_.find_file(item, "field", field.file);
    if (!found) return {};
    Result<FieldGrid> grid = read_field_file(*found, edge_m_);
    if (grid) return std::make_shared<const FieldGrid>(std::move(*grid));
    builder_.fail(item, grid.error().message());
    return {};
  }

 private:
  /// The formula on a grid about the field's middle, as a file would bring it.
  template <class Formula>
  Made sampled_grid(const Formula& formula, const SampledGrid& wanted) const {
    const std::string table = item_path(path_, "sampled");
    GridShape shape;
    shape.nodes = {wanted.nodes, wanted.nodes, wanted.nodes};
    if (shape.count() > kMostSampledNodes) {
      builder_.fail(item_path(table, "nodes"), "so many nodes take too much memory",
                    fmt::format("{}", shape.count()), fmt::format("at most {} in all", kMostSampledNodes));
      return {};
    }
    shape.spacing = wanted.size_m / (wanted.nodes - 1);
    shape.origin = -0.5 * wanted.size_m;
    if (const Result<void> fine = check_shape(shape); !fine) {
      builder_.fail(item_path(table, "size_m"), fine.error());
      return {};
    }
    Result<FieldGrid> grid =
        FieldGrid::make(shape,
                        wanted.type == SampleType::kFloat32 ? samples_of<float>(formula, shape)
                                                            : samples_of<double>(formula, shape),
                        edge_m_);
    if (grid) return std::make_shared<const FieldGrid>(std::move(*grid));
    builder_.fail(item_path(table, "nodes"), grid.error().message());
    return {};
  }

  SceneBuilder& builder_;
  const std::string& path_;
  double edge_m_;
};

}  // namespace

void build_fields(SceneBuilder& builder, Scene& scene) {
  for (const FieldDescription& description : builder.description().fields) {
    const std::string path = item_path("", "field", scene.world.fields.size());
    ForceField field;
    field.X_WF = description.X_WF;
    field.scale = description.scale;
    field.largest_force_N = description.largest_force_N.value_or(field.largest_force_N);
    field.largest_torque_Nm = description.largest_torque_Nm.value_or(field.largest_torque_Nm);
    field.shape = std::visit(FieldMaker(builder, path, description.edge_m.value_or(0.0)), description.shape);
    scene.world.fields.push_back(std::move(field));
    if (builder.errors()) return;
  }
  if (scene.world.fields.empty()) return;
  for (Body& body : scene.world.bodies)
    if (body.moves() && body.field_points.empty())
      body.field_points = spread_over(body.part->surface, kFieldPoints);
}

}  // namespace tactum::inline v0_1
