#include "cut/element_map.hpp"

namespace ngsxfem_contact
{
  using ngfem::ElementId, ngfem::VOL;

  Triangle VerticesOf (const MeshAccess & mesh, size_t element)
  {
    auto vertices = mesh.GetElement(ElementId(VOL, element)).Vertices();
    return { mesh.GetPoint<2>(vertices[0]), mesh.GetPoint<2>(vertices[1]), mesh.GetPoint<2>(vertices[2]) };
  }

  bool IsInterface (const MeshAccess & mesh, size_t bnd_element)
  {
    ngcore::Array<int> neighbours;
    mesh.GetEdgeElements(mesh.GetElement(ElementId(ngfem::BND, bnd_element)).Edges()[0], neighbours);
    return neighbours.Size() > 1;
  }

  ElementMap :: ElementMap (const MeshAccess & amesh, size_t aelement)
    : mesh(amesh), element(aelement), t(VerticesOf(mesh, element)), curved(mesh.GetElement(ElementId(VOL, element)).is_curved) { }

  Point ElementMap :: Reference (Point p) const
  {
    // p = t[2] + ξ (t[0]-t[2]) + η (t[1]-t[2])
    Point a = t[0]-t[2], b = t[1]-t[2], d = p-t[2];
    double det = Cross(a, b);
    return Point(Cross(d, b)/det, Cross(a, d)/det);
  }

  ElementMap::Image ElementMap :: At (Point p) const
  {
    if (!curved) return { p, Point(1., 0.), Point(0., 1.) };
    ngcore::LocalHeapMem<20000> lh("element map");
    Point r = Reference(p), a = t[0]-t[2], b = t[1]-t[2], x;
    ngbla::Mat<2,2> J;
    mesh.GetTrafo(ElementId(VOL, element), lh).CalcPointJacobian(ngfem::IntegrationPoint(r(0), r(1), 0, 0), x, J);
    Point by_xi(J(0,0), J(1,0)), by_eta(J(0,1), J(1,1));
    double det = Cross(a, b);
    return { x, Point(1/det * (b(1)*by_xi - a(1)*by_eta)), Point(1/det * (a(0)*by_eta - b(0)*by_xi)) };
  }

  double ElementMap :: Bulge () const
  {
    double bulge = 0;
    for (int i = 0; curved && i < 3; i++)
      for (double x : { 0.25, 0.5, 0.75 })
        {
          Point p = Lerp(t[i], t[(i+1)%3], x);
          bulge = std::max(bulge, Norm(Point(Value(p)-p)));
        }
    return bulge;
  }

  std::optional<Point> ElementMap :: Inverse (Point x) const
  {
    if (!curved) return x;
    Point p = x;
    double h = LongestEdge(t), last = std::numeric_limits<double>::infinity();
    for (int it = 0; it < 20; it++)
      {
        auto [value, d0, d1] = At(p);
        Point r = x-value;
        double det = Cross(d0, d1), step = 0;
        if (!(det > 0.05)) return std::nullopt;
        Point dp(Cross(r, d1)/det, Cross(d0, r)/det);
        p = p+dp;
        step = Norm(dp);
        if (step > 0.5*h) return std::nullopt;
        if (step <= 1e-15*h || (step <= 1e-12*h && step >= 0.5*last)) return p;      // as well as round-off allows
        last = step;
      }
    return std::nullopt;
  }

  ngfem::IntegrationPoint ElementMap :: InReference (Point p, double weight) const
  {
    Point reference = Reference(p);
    return ngfem::IntegrationPoint(reference(0), reference(1), 0, weight/(2*Area(t)));
  }

  ngfem::IntegrationPoint ElementMap :: PhysicalInReference (Point x, double weight) const
  {
    Point p = Inverse(x).value();
    auto [value, d0, d1] = At(p);
    return InReference(p, weight/Cross(d0, d1));
  }

  EdgeMap :: EdgeMap (const MeshAccess & mesh, size_t bnd_element)
  {
    auto v = mesh.GetElement(ElementId(ngfem::BND, bnd_element)).Vertices();
    a = mesh.GetPoint<2>(v[1]);
    b = mesh.GetPoint<2>(v[0]);
  }

  ngfem::IntegrationPoint EdgeMap :: InReference (Point p, double weight) const
  {
    Point ab = b-a;
    return ngfem::IntegrationPoint(Dot(Point(p-a), ab)/Dot(ab, ab), 0, 0, weight/Length());
  }
}
