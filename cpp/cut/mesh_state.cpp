#include "cut/mesh_state.hpp"

namespace ngsxfem_contact
{
  using ngcore::Exception;

  MeshState :: MeshState (ngcomp::MeshAccess & mesh)
    : num_elements(mesh.GetNE(ngfem::VOL)), num_vertices(mesh.GetNV()), curve_order(mesh.GetCurveOrder())
  {
    if (mesh.GetDeformation())
      throw Exception("CrackedMesh: the mesh is moved by SetDeformation, which cracks and rules know nothing of; build a mesh of the moved body");
  }

  void MeshState :: Check (ngcomp::MeshAccess & mesh) const
  {
    string how = mesh.GetDeformation() ? "it is moved by SetDeformation" : mesh.GetCurveOrder() != curve_order ? "it was curved" : "it was refined";
    if (mesh.GetDeformation() || mesh.GetCurveOrder() != curve_order || mesh.GetNE(ngfem::VOL) != num_elements || mesh.GetNV() != num_vertices)
      throw Exception("CrackedMesh: the mesh has changed since the cracks were located in it (" + how + "); build a new CrackedMesh, and all else on it anew");
  }
}
