// SPDX-License-Identifier: GPL-2.0-or-later
// What an engine finds around it in each step: other engines, its bodies, and whether they are those that it knows.
#include "CableCheck.hpp"
#include "CableEngine.hpp"
#include "CableNodes.hpp"
#include "Drive.hpp"
#include "SceneCheck.hpp"

#include <algorithm>
#include <cmath>

namespace yade {

namespace {
    constexpr int checkInterval = 100;      // steps between two looks at what cables may meet
    constexpr size_t elementsAtOnce = 1000; // whose bodies are looked at in a step
    constexpr Real deepestStart = .5;       // overlap in the smaller radius of both; more is refused
    constexpr Real deepStart = .1;          // more is warned of
    constexpr Real roundedLength = 1e-9;    // part by which an element may be shorter than thick
} // namespace

// ---------------------------------------------------------------- engines

void CableEngine::checkScene() const {
    const Scene& s = theScene();
    if (s.isPeriodic) refuse("a periodic cell is not supported: set O.periodic = False");
    checkNumbers();
}

// Of bodies that were loaded from a file.
void CableEngine::checkNumbers() const {
    const BodyContainer& bodies = *theScene().bodies;
    for (size_t id = 0; id < bodies.size(); ++id) {
        const Body* body = bodies[id].get();
        if (!body) continue;
        if (body->id != static_cast<Body::id_t>(id))
            refuse(text("body ", id, " says that its id is ", body->id, ": the saved scene is damaged, load another"));
        if (body->isClumpMember() && !(bodies.exists(body->clumpId) && bodies[body->clumpId]->isClump()))
            refuse(text("body ", id, " says that it is a member of clump ", body->clumpId,
                        ", which is none: the saved scene is damaged, load another"));
    }
}

// A body whose drive is gone, or switched off, would go on at its last speed.
void CableEngine::checkDriven() {
    const Scene& s = theScene();
    const vector<Body::id_t> before = std::move(driven);
    driven.clear();
    eachDrive(s,
              [&](const Drive& drive) { driven.insert(driven.end(), drive.bodies().begin(), drive.bodies().end()); });
    for (const Body::id_t id : before) {
        if (has(driven, id) || !s.bodies->exists(id)) continue;
        const State& state = *(*s.bodies)[id]->state;
        if (state.vel == Vector3r::Zero() && state.angVel == Vector3r::Zero()) continue;
        driven = before;
        refuse(text("body ", id,
                    " was driven by an engine that is dead or no longer in O.engines, and would go on at "
                    "its last speed: put the engine back, or set its state.vel and state.angVel to zero"));
    }
}

void CableEngine::checkSurroundings() const {
    const SceneCheck check(theScene());
    check.engines();
    check.functors();
}

void CableEngine::check() {
    const SceneCheck scenes(theScene());
    scenes.engines();
    const CableCheck mine(*this);
    mine.others();
    mine.partners(0);
    scenes.functors();
    if (theScene().iter == 0 || lastStep == 0) checkStart();
}

// What is laid out badly, as far as it shows before the first step.
void CableEngine::checkStart() {
    int worst = -1, shortOnes = 0;
    for (int e = 0; e < static_cast<int>(elementIds.size()); ++e) {
        if (elementIds[e] < 0 || length[e] >= (1 - roundedLength) * 2 * radius[e]) continue;
        ++shortOnes;
        if (worst < 0 || length[e] / radius[e] < length[worst] / radius[worst]) worst = e;
    }
    if (worst >= 0)
        warn(text(fullName(elementBody(worst)), " is ", length[worst], " m long, but ", 2 * radius[worst],
                  " m thick, the worst of ", shortOnes, " such elements of CableEngine ", family,
                  ": one body touches several of them at once, and the contact is stiffer than its materials are; take "
                  "fewer elements, or midPoints"));
    if (!model) build();
    model->x = position.data();
    const vector<Overlap> found = CableCheck(*this).overlaps(deepStart);
    if (found.empty()) return;
    const Overlap& deepest = *std::max_element(found.begin(), found.end(), [](const Overlap& a, const Overlap& b) {
        return a.depth / a.radius < b.depth / b.radius;
    });
    const BodyContainer& bodies = *theScene().bodies;
    const string what = text(fullName(*bodies[deepest.first]), " and ", fullName(*bodies[deepest.second]),
                             " start with an overlap of ", deepest.depth, " m at (", deepest.at[0], ", ", deepest.at[1],
                             ", ", deepest.at[2], "), ", std::lround(100 * deepest.depth / deepest.radius),
                             "% of the smaller radius ", deepest.radius, " m, the worst of ", found.size()),
                 remedy = "move one of them, or separate them by groupMask";
    if (deepest.depth > deepestStart * deepest.radius) throw std::invalid_argument(text(what, ": ", remedy));
    warn(text(what, ", and spring apart unless they are at rest: ", remedy));
}

// ---------------------------------------------------------------- bodies

const Body& CableEngine::elementBody(int element) const {
    const Scene& s = theScene();
    const Body::id_t id = elementIds[element];
    if (!s.bodies->exists(id))
        refuse(text("body ", id, " of element ", element,
                    " was erased, or belongs to a scene before O.reset(): erase the whole cable with its engine, or "
                    "make one that touches nothing (contactPoints=0)"));
    return *(*s.bodies)[id];
}

namespace {
    bool shows(const Body& body, int element, int family) {
        const CableElement* shape = CableElement::of(body);
        return shape && shape->element == element && shape->family == family;
    }
} // namespace

// A body could have been erased, and its number or shape be another's. Looks at no more than `most` elements; those
// behind them come in the next call.
void CableEngine::checkBodies(size_t most) const {
    const Scene& s = theScene();
    const auto size = static_cast<Body::id_t>(s.bodies->size());
    const shared_ptr<Body>* bodies = size > 0 ? &(*s.bodies)[0] : nullptr; // one call, not one each
    const size_t n = elementIds.size();
    bool all = elementBodies.size() == n;
    for (size_t i = std::min(most, n); i > 0 && all; --i) {
        if (nextBody >= n) nextBody = 0;
        const size_t e = nextBody++;
        const Body::id_t id = elementIds[e];
        if (id < 0) continue;
        const Shown& known = elementBodies[e];
        all = id < size && bodies[id].get() == known.body && known.body->shape.get() == known.shape;
    }
    if (!all) lookAtBodies();
    for (size_t i = 0; i < carryIds.size(); ++i)
        if (!s.bodies->exists(carryIds[i]))
            refuse(text("body ", carryIds[i], ", which node ", carryNodes[i],
                        " carries, was erased: its mass cannot be taken off a cable; let it live"));
    for (size_t i = 0; i < followIds.size(); ++i)
        if (!s.bodies->exists(followIds[i]))
            refuse(text("body ", followIds[i], ", which node ", followNodes[i],
                        " follows, was erased: release() the node first"));
}

void CableEngine::lookAtBodies() const {
    elementBodies.clear(); // looked at again, as long as one is refused
    vector<Shown> all(elementIds.size(), {nullptr, nullptr});
    for (size_t e = 0; e < all.size(); ++e) {
        if (elementIds[e] < 0) continue;
        const int element = static_cast<int>(e);
        const Body& body = elementBody(element);
        if (!shows(body, element, family))
            refuse(text(fullName(body), " stands in the place of element ", e,
                        ", whose body or shape was replaced: give it back body.shape, or erase the whole cable with "
                        "its engine"));
        all[e] = {&body, body.shape.get()};
    }
    elementBodies = std::move(all);
}

// Bodies that nodes carry or follow are those that they were, and can be moved. True: the model has other masses.
bool CableEngine::heldBodiesChanged() {
    const BodyContainer& bodies = *theScene().bodies;
    const auto same = [&](const Held& known, Body::id_t id) {
        const Body& body = *bodies[id];
        const State& state = *body.state;
        return known.at == &body && known.state == &state && known.mass == state.mass &&
               known.inertia == state.inertia && known.blocked == state.blockedDOFs && known.clump == body.clumpId &&
               !known.body.expired();
    };
    bool all = carried.size() == carryIds.size() && followed.size() == followIds.size();
    for (size_t i = 0; i < carryIds.size() && all; ++i) all = same(carried[i], carryIds[i]);
    for (size_t i = 0; i < followIds.size() && all; ++i) all = same(followed[i], followIds[i]);
    return !all && lookAtHeldBodies();
}

bool CableEngine::lookAtHeldBodies() {
    const Scene& s = theScene();
    const boost::weak_ptr<Body> none;
    const auto same = [](const auto& a, const auto& b) { return !a.owner_before(b) && !b.owner_before(a); };
    const auto look = [&](vector<Held>& known, const vector<int>& ids, const vector<int>& nodes, const char* what) {
        known.resize(ids.size());
        for (size_t i = 0; i < ids.size(); ++i) {
            const shared_ptr<Body>& body = (*s.bodies)[ids[i]];
            if (same(known[i].body, none)) known[i] = {body, body.get(), nullptr, 0, Vector3r::Zero(), 0, 0};
            if (!same(known[i].body, body))
                refuse(text(fullName(*body), " took the place of the body that node ", nodes[i], " ", what,
                            ": put that back, or build the cable anew"));
        }
    };
    look(followed, followIds, followNodes, "follows");
    look(carried, carryIds, carryNodes, "carries");
    for (size_t i = 0; i < carryIds.size(); ++i) checkCarried(i);
    bool other = false;
    const auto note = [&](Held& known, Body::id_t id) {
        const Body& body = *(*s.bodies)[id];
        const State& state = *body.state;
        known = {known.body, &body, &state, state.mass, state.inertia, state.blockedDOFs, body.clumpId};
    };
    for (size_t i = 0; i < carryIds.size(); ++i) {
        other = other || carried[i].mass != (*s.bodies)[carryIds[i]]->state->mass;
        note(carried[i], carryIds[i]);
    }
    for (size_t i = 0; i < followIds.size(); ++i) note(followed[i], followIds[i]);
    return other;
}

void CableEngine::checkCarried(size_t i) const {
    const Scene& s = theScene();
    const Body& body = *(*s.bodies)[carryIds[i]];
    const State& state = *body.state;
    const auto must = [&](bool good, const char* name, const auto& value, const char* rule) {
        if (!good)
            refuse(text(fullName(body), ", which node ", carryNodes[i], " carries: ", name, " = ", value, ": ", rule));
    };
    must(state.mass > 0 && std::isfinite(state.mass), "state.mass", state.mass, "must be finite and above 0 [kg]");
    must(!body.isClumpMember(), "clumpId", body.clumpId, "must stay on its own: carry the clump instead");
    for (int c = 0; c < 3; ++c)
        must(state.blockedDOFs & (State::DOF_RX << c) || placedByDrive(s, body) ||
                 (state.inertia[c] > 0 && std::isfinite(state.inertia[c])),
             "state.inertia", state.inertia[c], "must be finite and above 0, or its rotation blocked [kg m²]");
    if (carrierOfBody[carryIds[i]] == static_cast<int>(i))
        must((state.blockedDOFs & State::DOF_XYZ) == State::DOF_XYZ, "state.blockedDOFs", state.blockedDOFs,
             "must hold 'xyz', as the node moves it");
}

// Bodies for which YADE would end at their first contact; told in our own step, as the collider cannot.
void CableEngine::checkPartners() {
    if (partnersChecked) return;
    CableCheck(*this).partners(0);
    partnersChecked = true;
}

void CableEngine::checkIntegrator() {
    mapBodies();
    if (integrator == "implicit") CableCheck(*this).implicit();
}

py::list CableEngine::overlaps(Real part) {
    if (!(part >= 0 && std::isfinite(part)))
        throw std::invalid_argument(text("CableEngine.overlaps: part = ", part, ": must be finite and not below 0"));
    if (!model) build();
    model->x = position.data();
    py::list all;
    for (const Overlap& one : CableCheck(*this).overlaps(part))
        all.append(py::make_tuple(one.first, one.second, one.at, one.depth, one.radius));
    return all;
}

// ---------------------------------------------------------------- before a step

void CableEngine::getReady() {
    const auto known = static_cast<Body::id_t>(carrierOfBody.size());
    uint64_t surroundings;
    followMaterials();
    try {
        surroundings = SceneCheck(*scene).print();
        const bool around = surroundings != checkedSurroundings;
        if (around) checkDriven();
        if (!pairsChecked) {
            build(); // engines that drive bodies may have come since
            heldBodiesChanged();
            check();
        } else {
            checkBodies(elementsAtOnce);
            if (around) checkSurroundings();
            if (known != static_cast<Body::id_t>(scene->bodies->size())) {
                CableCheck(*this).partners(known);
                balanceGoesOn = false; // what is new may press from the start
            }
            if (around || known != static_cast<Body::id_t>(scene->bodies->size())) checkIntegrator();
            if (heldBodiesChanged() || !model) build();
            if (++sinceChecked >= checkInterval) {
                lookAtBodies();
                CableCheck(*this).partners(0);
            }
        }
    } catch (const std::invalid_argument& error) { // a ValueError of check() is a RuntimeError of a step
        scene->doSort = true;
        throw std::runtime_error(error.what());
    } catch (...) {
        scene->doSort = true; // the collider may have seen no elements in this step
        throw;
    }
    if (sinceChecked >= checkInterval) sinceChecked = 0;
    pairsChecked = true;
    checkedSurroundings = surroundings;
}

} // namespace yade
