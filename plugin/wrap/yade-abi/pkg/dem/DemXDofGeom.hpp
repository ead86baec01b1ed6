// SPDX-License-Identifier: GPL-2.0-or-later
// Contact geometry common to all that have a point and a normal.
#pragma once

#include <core/IGeom.hpp>

namespace yade {

class GenericSpheresContact : public IGeom {
public:
    Vector3r normal; // from the first body to the second
    Vector3r contactPoint;
    Real refR1;
    Real refR2;

    GenericSpheresContact() : normal(Vector3r::Zero()), contactPoint(Vector3r::Zero()), refR1(0), refR2(0) {
        createIndex();
    }
    ANCF_PACKAGED(GenericSpheresContact)
    ANCF_PACKAGED_INDEX
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(GenericSpheresContact)
