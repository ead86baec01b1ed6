// SPDX-License-Identifier: GPL-2.0-or-later
// What an engine's cables may meet: refused, by name, where their contact cannot be computed.
#pragma once

#include "CableElement.hpp"

#include <map>

extern "C" {
#include "ancf/solid.h"
}

namespace yade {

class CableEngine;

// The first is an element's body or a sphere that a knot carries; the second any body.
struct Overlap {
    Body::id_t first, second;
    Vector3r at;        // on the centreline, or the centre of the sphere [m]
    Real depth, radius; // at its deepest; the smaller radius of both [m]
};

class CableCheck {
    const CableEngine& cable;
    vector<const Body*> carried;                 // by knots, the members of clumps one by one
    std::map<int, vector<const Body*>> elements; // by their masks

    void checkSolid(const Body& body) const;
    void checkMaterial(const Body& body) const;
    void checkMotion(const Body& body) const;
    void overlapsOfElements(vector<Overlap>& found, Real part) const;
    void overlapsOfCarried(vector<Overlap>& found, Real part) const;
    void crossings(vector<Overlap>& found, Real part) const;

public:
    explicit CableCheck(const CableEngine& cable); // refuses bodies that were erased

    bool mayMeet(const Body& body) const;      // a cable, or a sphere that a knot carries
    void others() const;                       // no cable of another engine, nor what it carries
    void partners(Body::id_t first) const;     // bodies from a number on
    void implicit() const;                     // what implicit steps cannot carry; invalid_argument
    vector<Overlap> overlaps(Real part) const; // deeper than a part of the smaller radius, of a built engine
};

} // namespace yade
