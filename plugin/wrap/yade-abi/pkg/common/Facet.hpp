// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Shape.hpp>

namespace yade {

class Facet : public Shape {
public:
    Vector3r ne[3]; // unit normals of the edges, in the plane
    Real icr;       // radius of the inscribed circle
    Real vl[3];     // distances of the vertices from the centre
    Vector3r vu[3]; // unit vectors from the centre to the vertices
    vector<Vector3r> vertices;
    Vector3r normal;
    Real area;

    Facet();
    void postLoad(Facet&);
    void setVertices(const Vector3r& v0, const Vector3r& v1, const Vector3r& v2);
    ANCF_PACKAGED(Facet)
    ANCF_PACKAGED_INDEX
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Facet)
