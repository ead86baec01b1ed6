// SPDX-License-Identifier: GPL-2.0-or-later
// How the coefficients of friction of two materials make those of their contact.
#pragma once

#include <core/Material.hpp>

namespace yade {

struct FrictionRule {
    enum Kind { MIN, MAX, MEAN } kind = MIN;
    const vector<int>* pairs = nullptr;     // ids of two materials each that have coefficients of their own
    const vector<Real>* friction = nullptr; // static and kinetic, of each pair

    // The coefficients of a contact: of its materials' own, infinite where one says nothing.
    Real mix(Real first, Real second) const;
    // Those of the pair, or null.
    const Real* own(const Material& first, const Material& second) const;
    // Of the rule and the pair's own coefficients, to go with a mark of the materials' values.
    long mark(long ofMaterials, const Material& first, const Material& second) const;
};

// A rule from what a functor has been given; invalid_argument that names the functor.
FrictionRule checkedRule(const string& functor, const string& rule, const vector<int>& pairs,
                         const vector<Real>& friction);

// Adds a pair, or gives it other coefficients; invalid_argument on bad values.
void setPairFriction(vector<int>& pairs, vector<Real>& friction, const string& functor, int first, int second,
                     Real staticFriction, Real kineticFriction);

} // namespace yade
