// SPDX-License-Identifier: GPL-2.0-or-later
// The body of a cable's element: what the collider and the contact functors see. Nobody moves it; it shows the curve of
// its CableEngine.
#pragma once

#include <core/Body.hpp>
#include <core/Dispatching.hpp>

#include <algorithm>
#include <atomic>

extern "C" {
#include "ancf/boxes.h"
#include "ancf/motion.h"
}

namespace yade {

// A sphere and an element that were too far apart to be found near, until they may have closed that.
struct Resting {
    Body::id_t ids[2] = {-1, -1};
    long epoch = -1;
    Real radius = 0;                   // of the sphere [m]
    Vector3r place = Vector3r::Zero(); // of the sphere against the mean of the cable's nodes, when they were looked at
    Real wake = 0;                     // until their ways, the element's in all, and what is looked for are longer [m]
};

// What the bodies of an engine's elements read of it; empty until it is built. Where the engine changes while functors
// read, in other threads, they go on with the one they have: it is kept until they are through.
struct CableView {
    explicit CableView(const shared_ptr<std::atomic<bool>>& flag) : inUse(flag) {}
    // From now on until the engine's own step it is read. False: there is a new one.
    bool use() const {
        if (!inUse->load()) inUse->store(true);
        return !outdated.load();
    }

    const shared_ptr<std::atomic<bool>> inUse; // this one, or others of the engine, in this step
    std::atomic<bool> outdated {false};
    const ancf_model* model = nullptr;
    const ancf_boxes* boxes = nullptr;
    const ancf_motion* motion = nullptr;
    vector<ancf_cover> cover; // by element
    // Pairs that rest, by the number of their Interaction, so that threads do not meet. Valid in one epoch: while the
    // motion is followed at the end of each step, as it is if any pair asked.
    mutable vector<Resting> resting;
    mutable std::atomic<bool> asked {false};
    bool followed = false; // at the end of the last step
    long epoch = 0;
};

class CableElement : public Shape {
    mutable shared_ptr<const CableView> kept;             // what `seen` points to
    mutable std::atomic<const CableView*> seen {nullptr}; // read by several threads

    const CableView* newView(const Scene& scene) const;

public:
    static constexpr int allHave = 1 << 29; // bit of groupMask by which the collider leaves pairs of elements out

    // The body's shape as a cable element, or null.
    static const CableElement* of(const Body& body) {
        const bool is = body.shape && body.shape->getClassIndex() == CableElement::getClassIndexStatic();
        return is ? static_cast<const CableElement*>(body.shape.get()) : nullptr;
    }
    bool excludes(Body::id_t other) const {
        return !exclude.empty() && std::find(exclude.begin(), exclude.end(), other) != exclude.end();
    }
    // Null where the engine is missing or cannot be built, which it tells in its own step.
    const CableView* view(const Scene& scene) const;

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR(CableElement, Shape,
        "One element of a cable, on the true curve of its :yref:`CableEngine`. Its body is blocked in all freedoms and "
        "has no mass; its position is the middle of the element when the collider last ran.",
        ((int, element, -1, Attr::readonly, "Number in the engine."))
        ((int, family, 0, Attr::readonly, "Number of its :yref:`CableEngine`."))
        ((Real, radius, 0, Attr::readonly, "Half the diameter of the cable [m]."))
        ((vector<int>, exclude, , , "Bodies that it never touches.")),
        createIndex();
    )
    // clang-format on
    REGISTER_CLASS_INDEX(CableElement, Shape)
};
REGISTER_SERIALIZABLE(CableElement);

class Bo1_CableElement_Aabb : public BoundFunctor {
public:
    void go(const shared_ptr<Shape>&, shared_ptr<Bound>&, const Se3r&, const Body*) override;
    FUNCTOR1D(CableElement)
    // clang-format off
    YADE_CLASS_BASE_DOC(Bo1_CableElement_Aabb, BoundFunctor,
        "Box around the control points of a :yref:`CableElement`, with the room that its engine leaves it to move in.")
    // clang-format on
};
REGISTER_SERIALIZABLE(Bo1_CableElement_Aabb);

} // namespace yade
