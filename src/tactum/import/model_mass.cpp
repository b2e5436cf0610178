#include "tactum/import/model_mass.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>

#include "tactum/mesh/mesh_import.h"
#include "tactum/repair/mesh_repair.h"

namespace tactum::inline v0_1 {
namespace {

/// Volume, and the inertia of density 1, about the shape's own centre.
struct UnitSolid {
  double volume = 0.0;
  Vec3 moments = Vec3::Zero();
};

UnitSolid unit_solid(const ModelShape& shape) {
  const Vec3 s = shape.size;
  const Vec3 sq = s.cwiseProduct(s);
  const double r_sq = sq.x(), height = s.y();
  UnitSolid solid;
  switch (shape.kind) {
    case ModelShapeKind::kBox:
      solid.volume = s.prod();
      solid.moments = solid.volume / 12.0 * Vec3(sq.y() + sq.z(), sq.x() + sq.z(), sq.x() + sq.y());
      break;
    case ModelShapeKind::kEllipsoid:
      solid.volume = 4.0 / 3.0 * kPi * s.prod();
      solid.moments = solid.volume / 5.0 * Vec3(sq.y() + sq.z(), sq.x() + sq.z(), sq.x() + sq.y());
      break;
    case ModelShapeKind::kBall:
      solid.volume = 4.0 / 3.0 * kPi * r_sq * s.x();
      solid.moments = Vec3::Constant(0.4 * solid.volume * r_sq);
      break;
    case ModelShapeKind::kCylinder:
    case ModelShapeKind::kCapsule: {
      const double ends = shape.kind == ModelShapeKind::kCapsule ? 4.0 / 3.0 * kPi * r_sq * s.x() : 0.0;
      const double middle = kPi * r_sq * height;
      const double across = middle * (r_sq / 4.0 + height * height / 12.0) +
                            ends * (0.4 * r_sq + 0.25 * height * height + 0.375 * height * s.x());
      solid.volume = middle + ends;
      solid.moments = Vec3(across, across, 0.5 * middle * r_sq + 0.4 * ends * r_sq);
      break;
    }
    case ModelShapeKind::kMesh:
    case ModelShapeKind::kPlane:
      break;
  }
  return solid;
}

/// The moments within the rules; the axes stay.
void apply_rules(const MassRules& rules, ModelInertial& inertial) {
  inertial.mass_kg = std::max(inertial.mass_kg, rules.least_mass_kg);
  if (!rules.balance && rules.least_inertia_kg_m2 <= 0.0) return;
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(inertial.inertia);
  Vec3 moments = solver.eigenvalues().cwiseMax(rules.least_inertia_kg_m2);
  if (rules.balance && moments[0] + moments[1] < moments[2]) moments = Vec3::Constant(moments.mean());
  inertial.inertia = solver.eigenvectors() * moments.asDiagonal() * solver.eigenvectors().transpose();
}

void scale_masses(double total_kg, ImportModel& model) {
  double sum_kg = 0.0;
  for (const ModelLink& link : model.links)
    if (link.inertial && link.at->name != "worldbody") sum_kg += link.inertial->mass_kg;
  if (!(sum_kg > 0.0)) return;
  for (ModelLink& link : model.links) {
    if (!link.inertial) continue;
    link.inertial->mass_kg *= total_kg / sum_kg;
    link.inertial->inertia *= total_kg / sum_kg;
  }
}

}  // namespace

const ModelMesh* ModelMeshes::find(const ModelShape& shape, ImportLog& log) {
  const std::pair key(shape.mesh, std::array{shape.size.x(), shape.size.y(), shape.size.z()});
  if (const auto known = meshes_.find(key); known != meshes_.end()) return &known->second;
  Result<ImportedMesh> imported = import_mesh(shape.mesh);
  if (!imported) {
    log.fail(*shape.at, "the mesh cannot be read", imported.error().message(), "");
    return nullptr;
  }
  TriangleMesh& mesh = imported->mesh;
  for (Vec3& vertex : mesh.vertices) vertex = vertex.cwiseProduct(shape.size);
  if (shape.size.prod() < 0.0)
    for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  ModelMesh known;
  known.mass = mass_properties_or_hull(repair_mesh(mesh).mesh, 1.0);
  known.box = bounds(with_used_vertices(std::move(mesh)).vertices);
  return &meshes_.emplace(key, std::move(known)).first->second;
}

ModelInertial together(const ModelInertial& a, const ModelInertial& b) {
  ModelInertial sum;
  sum.mass_kg = a.mass_kg + b.mass_kg;
  if (!(sum.mass_kg > 0.0)) return sum;
  sum.center = (a.mass_kg * a.center + b.mass_kg * b.center) / sum.mass_kg;
  for (const ModelInertial* one : {&a, &b}) {
    const Vec3 r = one->center - sum.center;
    sum.inertia += one->inertia + one->mass_kg * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
  }
  return sum;
}

ModelInertial placed(const Pose& X, const ModelInertial& inertial) {
  return {inertial.mass_kg, X * inertial.center, X.R * inertial.inertia * X.R.transpose()};
}

ModelInertial inertial_of(const ModelShape& shape, ModelMeshes& meshes, ImportLog& log) {
  ModelInertial own;
  double volume = 0.0;
  if (shape.kind == ModelShapeKind::kMesh) {
    const ModelMesh* mesh = meshes.find(shape, log);
    if (mesh == nullptr) return own;
    volume = mesh->mass.volume;
    own.center = mesh->mass.center;
    own.inertia = mesh->mass.inertia;
  } else {
    const UnitSolid solid = unit_solid(shape);
    volume = solid.volume;
    own.inertia = solid.moments.asDiagonal();
  }
  if (!(volume > 0.0)) return {};
  own.mass_kg = shape.mass_kg.value_or(shape.density_kg_per_m3 * volume);
  own.inertia *= own.mass_kg / volume;
  return placed(shape.X_LS, own);
}

void complete_masses(ImportModel& model, ModelMeshes& meshes, ImportLog& log) {
  const MassRules& rules = model.masses;
  for (ModelLink& link : model.links) {
    const bool stated = link.inertial && rules.from_shapes != MassRules::FromShapes::kAlways;
    if (!stated && rules.from_shapes != MassRules::FromShapes::kNever) {
      ModelInertial sum;
      for (const ModelShape& shape : link.shapes)
        if (shape.weighs) sum = together(sum, inertial_of(shape, meshes, log));
      if (sum.mass_kg > 0.0) link.inertial = sum;
    }
    if (link.inertial) apply_rules(rules, *link.inertial);
  }
  if (rules.total_mass_kg) scale_masses(*rules.total_mass_kg, model);
}

}  // namespace tactum::inline v0_1
