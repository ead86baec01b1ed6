// SPDX-License-Identifier: GPL-2.0-or-later
#include "CableRest.hpp"

#include "CableEngine.hpp"
#include "CableGeom.hpp"
#include "CableNodes.hpp"
#include "text.hpp"

#include <cmath>

namespace yade {

CableRest::CableRest(const CableEngine& engine) : cable(engine) {
    const Scene& s = cable.theScene();
    readElements();
    for (const auto& body : *s.bodies)
        if (body) addBody(*body);
    addPairs();
    if (obstacles.empty() && !cablesMeet()) return;
    for (size_t i = 0; i < obstacles.size(); ++i) { // now that they stay where they are
        obstacles[i].law = laws[i].data();
        const auto found = without.find(bodies[i]->id);
        if (found == without.end()) continue;
        obstacles[i].excluded = found->second.data();
        obstacles[i].n_excluded = static_cast<int>(found->second.size());
    }
    ancf_rest* made = nullptr;
    if (ancf_rest_create(&made, cable.theModel(), cable.touching.view()->cover.data(),
                         cable.touching.lawsOfKinds().data(), static_cast<int>(kinds.size()), obstacles.data(),
                         static_cast<int>(obstacles.size()), pairs.data(), static_cast<int>(pairs.size())))
        throw std::bad_alloc();
    rest.reset(made);
}

void CableRest::readElements() {
    const auto& cover = cable.touching.view()->cover;
    for (size_t e = 0; e < cover.size(); ++e) {
        if (!(cover[e].radius > 0)) continue;
        const Body& body = cable.elementBody(static_cast<int>(e));
        const size_t kind = static_cast<size_t>(cover[e].kind);
        if (kinds.size() <= kind) kinds.resize(kind + 1, nullptr);
        kinds[kind] = &body;
        for (const Body::id_t id : CableElement::of(body)->exclude) {
            vector<int>& elements = without[id];
            if (elements.empty() || elements.back() != static_cast<int>(e)) elements.push_back(static_cast<int>(e));
        }
    }
}

bool CableRest::cablesMeet() const {
    const auto& cover = cable.touching.view()->cover;
    int structure = -1;
    for (const ancf_cover& c : cover) {
        if (!(c.radius > 0)) continue;
        if (c.own || (structure >= 0 && c.structure != structure)) return true;
        structure = c.structure;
    }
    return false;
}

ancf_normal CableRest::lawOf(const Body& first, const Body& second) const {
    HollarsPhys phys;
    const Real radius = radiusOfContact(*first.shape, *second.shape);
    mixHollars(phys, static_cast<const ElastMat&>(*first.material), static_cast<const ElastMat&>(*second.material),
               radius, FrictionRule()); // nothing holds by friction
    phys.normalKind = cable.normalKind;
    if (const string fault = lawFault(phys, first.material.get(), second.material.get(), radius); !fault.empty())
        cable.refuse(text("relax: the contact of bodies ", first.id, " and ", second.id, ": ", fault));
    return phys.normalLaw();
}

// Nothing for what cables cannot touch.
void CableRest::addBody(const Body& body) {
    ancf_obstacle o {};
    if (!body.shape || body.isClump() || !body.isBounded() || !dynamic_cast<const ElastMat*>(body.material.get()) ||
        !solidOf(o.solid, body))
        return;
    const Body& moved = movedBody(cable.theScene(), body);
    const int carrier = cable.carrierOf(moved.id);
    o.node = carrier < 0 ? -1 : cable.carryNodes[static_cast<size_t>(carrier)];
    for (int c = 0; c < 3; ++c) o.arm[c] = body.state->pos[c] - moved.state->pos[c];
    o.mask = static_cast<int>(body.groupMask);
    laws.emplace_back();
    for (const Body* element : kinds) laws.back().push_back(lawOf(*element, body));
    bodies.push_back(&body);
    obstacles.push_back(o);
}

// Spheres that knots carry, with all others.
void CableRest::addPairs() {
    const Scene& s = cable.theScene();
    for (size_t i = 0; i < bodies.size(); ++i) {
        if (obstacles[i].node < 0 || !CarriedSphere::is(*bodies[i])) continue;
        for (size_t j = 0; j < bodies.size(); ++j) {
            const Body &ball = *bodies[i], &other = *bodies[j];
            if (j <= i && obstacles[j].node >= 0 && CarriedSphere::is(other)) continue; // itself, or met before
            if (&movedBody(s, ball) == &movedBody(s, other) || !(ball.groupMask & other.groupMask)) continue;
            pairs.push_back({static_cast<int>(i), static_cast<int>(j), lawOf(ball, other)});
        }
    }
}

string CableRest::moved() const {
    const Scene& s = cable.theScene();
    std::map<const Body*, std::pair<Vector3r, Vector3r>> pressed; // force, moment about the origin
    for (size_t i = 0; i < obstacles.size(); ++i) {
        auto& [force, moment] =
            pressed.insert({&movedBody(s, *bodies[i]), {Vector3r::Zero(), Vector3r::Zero()}}).first->second;
        force += Vector3r(obstacles[i].force[0], obstacles[i].force[1], obstacles[i].force[2]);
        moment += Vector3r(obstacles[i].moment[0], obstacles[i].moment[1], obstacles[i].moment[2]);
    }
    for (const auto& body : *s.bodies) { // the first by number
        const auto found = body ? pressed.find(body.get()) : pressed.end();
        if (found == pressed.end()) continue;
        const auto& [force, moment] = found->second;
        const Mobility m = mobility(s, *body);
        const int carrier = cable.carrierOf(body->id);
        const Vector3r at = carrier < 0 ? body->state->pos
                                        : nodeOf(cable.theModel()->x, cable.theModel()->stride,
                                                 cable.carryNodes[static_cast<size_t>(carrier)]);
        const Vector3r torque = moment - at.cross(force);
        constexpr Real rounding = 1e-9; // of the moment that the force has over a metre, and over its distance
        if (m.massPart() * force != Vector3r::Zero())
            return text("the cables press on body ", body->id,
                        ", which may move: fix it, or let the scene come to rest "
                        "instead");
        if (m.inverseInertia * torque != Vector3r::Zero() &&
            torque.norm() >
                rounding * force.norm() * (at.norm() + *std::max_element(cable.radius.begin(), cable.radius.end())))
            return text("body ", body->id,
                        " is pressed so that it would turn: block its rotation, or let the scene come "
                        "to rest instead");
    }
    return "";
}

} // namespace yade
