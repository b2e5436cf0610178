#include <assimp/BaseImporter.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>
#include <memory>

#include "tactum/mesh/gltf_check.h"
#include "tactum/mesh/mesh_builder.h"

/// glTF and GLB by assimp, from the reduced copy that gltf_check.h writes. No post-processing: triangles come
/// as they are, node transforms are applied here, and a mirroring transform turns the triangles round.

namespace tactum::inline v0_1::detail {
namespace {

/// An importer that knows glTF 2 and nothing else: no other loader gets to look at the bytes.
std::unique_ptr<Assimp::Importer> gltf_importer() {
  auto importer = std::make_unique<Assimp::Importer>();
  for (std::size_t i = importer->GetImporterCount(); i-- > 0;) {
    if (std::string_view(importer->GetImporterInfo(i)->mName).starts_with("glTF2")) continue;
    Assimp::BaseImporter* loader = importer->GetImporter(i);
    importer->UnregisterLoader(loader);
    delete loader;
  }
  return importer;
}

Vec3 wide(const aiVector3D& v) { return Eigen::Vector3f(v.x, v.y, v.z).cast<double>(); }

Mat3 linear_part(const aiMatrix4x4& X) {
  Eigen::Matrix3f R;
  R << X.a1, X.a2, X.a3, X.b1, X.b2, X.b3, X.c1, X.c2, X.c3;
  return R.cast<double>();
}

Result<void> add_mesh(const aiMesh& mesh, const aiMatrix4x4& X, MeshBuilder& builder) {
  const Mat3 R = linear_part(X);
  const Vec3 p = wide({X.a4, X.b4, X.c4});
  const bool mirrored = R.determinant() < 0.0;
  const std::string place = "mesh " + in_quotes(mesh.mName.C_Str());
  builder.begin_group(mesh.mName.C_Str());
  const int first = builder.vertex_count();
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    if (Result<void> done = builder.add_vertex(R * wide(mesh.mVertices[i]) + p, place); !done) return done;
  }
  std::vector<int> corners;
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    corners.clear();
    for (unsigned k = 0; k < face.mNumIndices; ++k) {
      if (face.mIndices[k] >= mesh.mNumVertices) {
        return builder.error("a face refers to a vertex that is not there", std::to_string(face.mIndices[k]),
                             "0 to " + std::to_string(mesh.mNumVertices - 1), place);
      }
      corners.push_back(first + static_cast<int>(face.mIndices[k]));
    }
    if (mirrored) corners = {corners.rbegin(), corners.rend()};
    if (Result<void> done = builder.add_polygon(corners, place); !done) return done;
  }
  return {};
}

Result<void> add_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& X_parent,
                      MeshBuilder& builder) {
  const aiMatrix4x4 X = X_parent * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) {
    if (Result<void> done = add_mesh(*scene.mMeshes[node.mMeshes[i]], X, builder); !done) return done;
  }
  for (unsigned i = 0; i < node.mNumChildren; ++i) {
    if (Result<void> done = add_node(scene, *node.mChildren[i], X, builder); !done) return done;
  }
  return {};
}

}  // namespace

Result<void> read_gltf(std::string_view bytes, MeshBuilder& builder) {
  builder.report().in_metres = true;
  const Result<std::string> glb = reduced_glb(bytes, builder);
  if (!glb) return glb.error();
  const std::unique_ptr<Assimp::Importer> importer = gltf_importer();
  const aiScene* scene = importer->ReadFileFromMemory(glb->data(), glb->size(), 0, "glb");
  if (scene == nullptr || scene->mRootNode == nullptr) {
    return builder.error("the glTF file cannot be read", importer->GetErrorString(), "a mesh");
  }
  return add_node(*scene, *scene->mRootNode, aiMatrix4x4(), builder);
}

}  // namespace tactum::inline v0_1::detail
