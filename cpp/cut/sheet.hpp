#pragma once
// S: a crack in space, the part of a plane, or of a surface that is one in other coordinates, that closed curves bound.

#include "cut/surface.hpp"

namespace ngsxfem_contact
{
  class Sheet
  {
    Plane plane;
    std::shared_ptr<const Surface> surface;  // nullptr: planar
    std::vector<Crack> loops;                // the outer one first, then those of the holes
    double size;                             // the largest distance of a point of the outer curve from its first one

  public:
    /// axes: directions of the plane's coordinates, made perpendicular and of unit length. loops: closed curves in these coordinates, the outer one
    /// first, in any direction of travel: they are turned so that S lies to the right.
    /// Throws for axes that are parallel, for curves that are not closed, that meet each other, and for holes that are not inside.
    Sheet (Point3 origin, std::array<Point3,2> axes, std::vector<Crack> aloops);
    /// The part of a surface that curves in its coordinates bound. Throws for the same curves.
    Sheet (std::shared_ptr<const Surface> asurface, std::vector<Crack> aloops);

    bool IsPlanar () const { return !surface; }
    const std::shared_ptr<const Surface> & GetSurface () const { return surface; }
    /// The point in flat coordinates, where the sheet is a region of GetPlane(): of a planar sheet the point itself.
    Point3 Flat (Point3 x) const { return surface ? surface->Flat(x) : x; }
    /// Of a planar sheet its plane, of another one p₃ = 0.
    const Plane & GetPlane () const { return plane; }
    Point3 PointAt (Point p) const { return surface ? surface->At(p).point : plane.Value(p); }
    /// Unit vectors n, a₁, a₂ at a point of the sheet.
    std::array<Point3,3> FrameAt (Point p) const;
    const std::vector<Crack> & Loops () const { return loops; }
    double Size () const { return size; }
    /// Whether a point of the plane lies in S.
    bool Contains (Point p) const { return loops[NearestLoop(p)].SideOf(p) == Side::Minus; }
    size_t NearestLoop (Point p) const;
    double Area () const;
    /// The corners of a box of its points in space.
    std::array<Point3,2> Bounds () const;

  private:
    void CheckLoops ();
  };
}
