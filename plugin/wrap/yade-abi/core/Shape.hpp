// SPDX-License-Identifier: GPL-2.0-or-later
// Geometry of a body.
#pragma once

#include <lib/multimethods/Indexable.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class BoundFunctor;
class InternalForceFunctor;

class Shape : public Serializable, public Indexable {
public:
    shared_ptr<BoundFunctor> boundFunctor; // cache of the dispatcher
    shared_ptr<InternalForceFunctor> internalforcefunctor;
    Vector3r color;
    bool wire;
    bool highlight;

    Shape() : color(Vector3r::Ones()), wire(false), highlight(false) {}
    ANCF_PACKAGED(Shape)
    ANCF_PACKAGED_INDEX_ROOT
};

} // namespace yade
ANCF_PACKAGED_REGISTERED(Shape)
