// SPDX-License-Identifier: GPL-2.0-or-later
// Box around a body, for the collider.
#pragma once

#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class Bound : public Serializable, public Indexable {
public:
    int lastUpdateIter;
    Vector3r refPos;
    Real sweepLength;
    Vector3r color;
    Vector3r min;
    Vector3r max;

    Bound()
        : lastUpdateIter(0), refPos(Vector3r::Constant(NaN)), sweepLength(0), color(Vector3r::Ones()),
          min(Vector3r::Constant(NaN)), max(Vector3r::Constant(NaN)) {}
    ANCF_PACKAGED(Bound)
    ANCF_PACKAGED_INDEX_ROOT
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Bound)
