// SPDX-License-Identifier: GPL-2.0-or-later
#include "CableCheck.hpp"

#include "CableEngine.hpp"
#include "CableGeom.hpp"
#include "CableNodes.hpp"
#include "Drive.hpp"
#include "text.hpp"

#include <core/Clump.hpp>

#include <array>
#include <cmath>

namespace yade {

namespace {
    bool positive(Real value) { return value > 0 && std::isfinite(value); }

    string nameOf(const Body& body) {
        const CableElement* element = CableElement::of(body);
        return element ? text("body ", body.id, " (CableElement ", element->element, ")")
                       : text("body ", body.id, " (", body.shape->getClassName(), ")");
    }

    string lettersOf(unsigned blocked) {
        const char* const all = "xyzXYZ";
        string letters;
        for (int i = 0; i < 6; ++i)
            if (blocked & (1u << i)) letters += all[i];
        return letters;
    }

    int bitsOf(const Body& body) { return static_cast<int>(body.groupMask) & ~CableElement::allHave; }

    // The shape itself; what derives from it has another form.
    bool isSolid(const Shape& shape) {
        for (const char* name : {"Sphere", "CarriedSphere", "Box", "Facet", "Wall", "Sheave"})
            if (shape.getClassName() == name) return true;
        return false;
    }

    struct Hull {
        Vector3r low, high;

        explicit Hull(const ancf_cubic& cubic) : low(cubic.control[0]), high(cubic.control[0]) {
            for (const auto& point : cubic.control) {
                low = low.cwiseMin(Vector3r(point));
                high = high.cwiseMax(Vector3r(point));
            }
        }
        Real distance(const Vector3r& point) const {
            return (low - point).cwiseMax(point - high).cwiseMax(Vector3r(Vector3r::Zero())).norm();
        }
    };
} // namespace

CableCheck::CableCheck(const CableEngine& engine) : cable(engine) {
    cable.needSound();
    cable.checkNumbers();
    cable.checkBodies();
    const Scene& s = cable.theScene();
    for (size_t e = 0; e < cable.elementIds.size(); ++e) {
        if (cable.elementIds[e] < 0) continue;
        cable.checkElementBody(static_cast<int>(e));
        const Body& body = cable.elementBody(static_cast<int>(e));
        elements[bitsOf(body)].push_back(&body);
    }
    for (const Body::id_t id : cable.carryIds) {
        const Body& body = *(*s.bodies)[id];
        if (!body.isClump()) {
            carried.push_back(&body);
            continue;
        }
        for (const auto& member : static_cast<const Clump&>(*body.shape).members)
            carried.push_back((*s.bodies)[member.first].get());
    }
}

void CableCheck::others() const {
    for (const auto& engine : cable.theScene().engines) {
        const auto* other = dynamic_cast<const CableEngine*>(engine.get());
        if (!other || other == &cable) continue;
        const CableCheck theirs(*other);
        const auto refuse = [&](const Body& mine, const Body& its, const char* what) {
            cable.refuse(text(nameOf(mine), " and ", nameOf(its), ", ", what, " of CableEngine ", other->family,
                              ", can meet, but cables see only those of their own engine: append both to one, "
                              "append(engine=other.engine), or give them groupMasks without a common bit"));
        };
        for (const auto& [mask, bodies] : elements) {
            for (const auto& [itsMask, its] : theirs.elements)
                if (mask & itsMask) refuse(*bodies.front(), *its.front(), "an element");
            for (const Body* body : theirs.carried)
                if (body->isBounded() && mask & bitsOf(*body)) refuse(*bodies.front(), *body, "carried by a knot");
        }
        for (const Body* mine : carried)
            for (const Body* body : theirs.carried)
                if (mine->isBounded() && body->isBounded() && bitsOf(*mine) & bitsOf(*body))
                    refuse(*mine, *body, "carried by a knot");
    }
}

bool CableCheck::mayMeet(const Body& body) const {
    if (!body.shape || body.isClump() || !body.isBounded() || CableElement::of(body)) return false;
    for (const auto& [mask, bodies] : elements) {
        if (!(body.groupMask & (mask | CableElement::allHave))) continue;
        for (const Body* element : bodies)
            if (!CableElement::of(*element)->excludes(body.id)) return true;
    }
    for (const Body* ball : carried)
        if (CarriedSphere::is(*ball) && ball != &body && body.groupMask & ball->groupMask) return true;
    return false;
}

void CableCheck::checkSolid(const Body& body) const {
    const Shape& shape = *body.shape;
    if (shape.getClassName() == "Subdomain")
        cable.refuse("yade.mpy spreads this scene over processes: call ancf.mpi.spread() before mpy.mpirun()");
    if (!isSolid(shape))
        cable.refuse(text(nameOf(body),
                          " can meet cables, which do not touch such a shape: keep it from them by groupMask, or build "
                          "it of spheres, boxes, facets, walls or sheaves"));
    if (const auto* sphere = dynamic_cast<const Sphere*>(&shape); sphere && !positive(sphere->radius))
        cable.refuse(text(nameOf(body), ": shape.radius = ", sphere->radius, ": must be finite and above 0 [m]"));
    if (const auto* box = dynamic_cast<const Box*>(&shape))
        for (const Real half : box->extents)
            if (!positive(half))
                cable.refuse(text(nameOf(body), ": shape.extents = (", box->extents[0], ", ", box->extents[1], ", ",
                                  box->extents[2], "): must be finite and above 0 [m]"));
    if (const auto* facet = dynamic_cast<const Facet*>(&shape); facet && !positive(facet->area))
        cable.refuse(text(nameOf(body), ": shape.area = ", facet->area,
                          ": must be finite and above 0 [m²]: its vertices lie on one line"));
}

void CableCheck::checkMaterial(const Body& body) const {
    const auto* elastic = dynamic_cast<const ElastMat*>(body.material.get());
    if (!elastic)
        cable.refuse(text(nameOf(body), " can meet cables, but its material is ",
                          body.material ? text("a ", body.material->getClassName()) : "None",
                          ": give it a HollarsMat or a FrictMat"));
    const auto need = [&](bool good, const char* name, Real value, const char* rule) {
        if (!good)
            cable.refuse(text(nameOf(body), ": material.", name, " = ", value, " (", elastic->getClassName(), " '",
                              elastic->label, "'): ", rule));
    };
    need(positive(elastic->young), "young", elastic->young, "must be finite and above 0 [Pa]");
    need(elastic->poisson > -1 && elastic->poisson <= .5, "poisson", elastic->poisson,
         "must be above -1 and at most 0.5");
    if (const auto* rough = dynamic_cast<const FrictMat*>(elastic))
        need(rough->frictionAngle >= 0 && rough->frictionAngle < M_PI / 2, "frictionAngle", rough->frictionAngle,
             "must be from 0 to below pi/2 [rad]");
}

// NewtonIntegrator divides by the mass and inertia of whatever is free to move.
void CableCheck::checkMotion(const Body& body) const {
    const Body& moved = movedBody(cable.theScene(), body);
    const State& state = *moved.state;
    const string name = &moved == &body ? nameOf(body) : text(nameOf(body), " of clump ", moved.id);
    const string remedy = text(" and may move (blockedDOFs = '", lettersOf(state.blockedDOFs),
                               "'): give it one, or fix it by blockedDOFs = 'xyzXYZ'");
    if (~state.blockedDOFs & State::DOF_XYZ && !positive(state.mass))
        cable.refuse(text(name, " can meet cables, has state.mass = ", state.mass, remedy));
    if (placedByDrive(cable.theScene(), moved)) return; // a guide does not let it turn
    for (int i = 0; i < 3; ++i)
        if (~state.blockedDOFs & (State::DOF_RX << i) && !positive(state.inertia[i]))
            cable.refuse(text(name, " can meet cables, has state.inertia = (", state.inertia[0], ", ", state.inertia[1],
                              ", ", state.inertia[2], ")", remedy));
}

void CableCheck::partners(Body::id_t first) const {
    const Scene& s = cable.theScene();
    for (size_t id = static_cast<size_t>(first); id < s.bodies->size(); ++id) {
        const Body* body = (*s.bodies)[id].get();
        if (!body) continue;
        if (const CableElement* stray = CableElement::of(*body); stray && stray->family == cable.family)
            if (const int e = stray->element;
                e < 0 || static_cast<size_t>(e) >= cable.elementIds.size() || cable.elementIds[e] != body->id)
                cable.refuse(text(nameOf(*body),
                                  " is none of its elementIds: a CableElement comes with its cable; make a "
                                  "Cable or Net, and erase this body"));
        if (!mayMeet(*body)) continue;
        checkSolid(*body);
        checkMaterial(*body);
        checkMotion(*body);
        if (const Vector3r& pos = body->state->pos; !std::isfinite(pos.sum()))
            cable.refuse(text(nameOf(*body), " can meet cables, and its state.pos = (", pos[0], ", ", pos[1], ", ",
                              pos[2], "): must be finite [m]"));
    }
}

void CableCheck::implicit() const {
    const auto refuse = [&](const string& why) {
        throw std::invalid_argument(
            text("CableEngine ", cable.family, ": integrator = 'implicit' ", why, ", or take integrator = 'leapfrog'"));
    };
    if (!elements.empty())
        refuse(text("knows no contact, and ", nameOf(*elements.begin()->second.front()),
                    " may touch something: make the cable with contactPoints=0"));
    for (size_t i = 0; i < cable.carryIds.size(); ++i)
        if (cable.carrierOf(cable.carryIds[i]) < 0)
            refuse(text("knows bodies at their centre alone, and node ", cable.carryNodes[i], " carries body ",
                        cable.carryIds[i], " off its centre or on a guide: carry it at (0, 0, 0)"));
    for (const auto& body : *cable.theScene().bodies)
        if (body && mayMeet(*body))
            refuse(text("knows no contact, and ", nameOf(*body),
                        " may touch a sphere that a knot carries: keep them apart by groupMask"));
}

// ---------------------------------------------------------------- overlaps

void CableCheck::overlapsOfElements(vector<Overlap>& found, Real part) const {
    std::array<ancf_nearest, CableEngine::segmentsMost + 1> places;
    struct Piece {
        const Body* body;
        const ancf_cover* cover;
        ancf_cubic cubic;
        Hull hull;
    };
    const BodyContainer& bodies = *cable.theScene().bodies;
    const auto isOther = [](const auto& body) {
        return body && !CableElement::of(*body) && body->shape && body->isBounded();
    };
    bool any = false;
    for (size_t id = 0; id < bodies.size() && !any; ++id) any = isOther(bodies[id]);
    if (!any) return;
    vector<Piece> pieces;
    pieces.reserve(cable.length.size());
    const auto view = cable.touching.view();
    for (const auto& [mask, those] : elements)
        for (const Body* body : those) {
            const int e = CableElement::of(*body)->element;
            if (cable.kind[e] & ANCF_WOUND) continue;
            ancf_cubic cubic;
            ancf_cover_cubic(&cubic, cable.theModel(), cable.theModel()->x, e);
            pieces.push_back({body, &view->cover[e], cubic, Hull(cubic)});
        }
    if (pieces.empty()) return;
    Hull all = pieces.front().hull;
    Real thickest = 0;
    for (const Piece& p : pieces) {
        all.low = all.low.cwiseMin(p.hull.low);
        all.high = all.high.cwiseMax(p.hull.high);
        thickest = std::max(thickest, p.cover->radius);
    }
    for (const auto& other : *cable.theScene().bodies) {
        ancf_solid solid;
        if (!isOther(other) || !solidOf(solid, *other)) continue;
        const auto* sphere = dynamic_cast<const Sphere*>(other->shape.get());
        const Real reach = ancf_solid_reach(&solid);
        if (all.distance(other->state->pos) > reach + thickest) continue;
        for (const Piece& p : pieces) {
            const Real radius = sphere ? std::min(sphere->radius, p.cover->radius) : p.cover->radius;
            if (!(other->groupMask & p.body->groupMask) || CableElement::of(*p.body)->excludes(other->id) ||
                p.hull.distance(other->state->pos) > reach + p.cover->radius)
                continue;
            const int n = ancf_cover_touch(places.data(), p.cover, &p.cubic, &solid, 0);
            const auto deepest = std::min_element(places.begin(), places.begin() + n,
                                                  [](const auto& a, const auto& b) { return a.gap < b.gap; });
            if (n > 0 && -deepest->gap > part * radius)
                found.push_back({p.body->id, other->id, Vector3r(deepest->point), -deepest->gap, radius});
        }
    }
}

void CableCheck::overlapsOfCarried(vector<Overlap>& found, Real part) const {
    const Scene& s = cable.theScene();
    for (const Body* ball : carried) {
        if (!CarriedSphere::is(*ball)) continue;
        const Real own = static_cast<const Sphere&>(*ball->shape).radius;
        for (const auto& other : *s.bodies) {
            ancf_solid solid;
            if (!other || CableElement::of(*other) || !other->shape || !other->isBounded() ||
                !(ball->groupMask & other->groupMask) || &movedBody(s, *ball) == &movedBody(s, *other) ||
                (has(carried, static_cast<const Body*>(other.get())) && other->id < ball->id) ||
                !solidOf(solid, *other))
                continue;
            Real normal[3];
            const Real depth = own - ancf_solid_distance(normal, &solid, ball->state->pos.data());
            const auto* sphere = dynamic_cast<const Sphere*>(other->shape.get());
            const Real radius = sphere ? std::min(own, sphere->radius) : own;
            if (depth > part * radius) found.push_back({ball->id, other->id, ball->state->pos, depth, radius});
        }
    }
}

void CableCheck::crossings(vector<Overlap>& found, Real part) const {
    const ancf_model* m = cable.theModel();
    const auto view = cable.touching.view();
    const auto& cover = view->cover;
    ancf_boxes* made = nullptr;
    if (ancf_boxes_create(&made, m, cover.data())) throw std::bad_alloc();
    const std::unique_ptr<ancf_boxes, void (*)(ancf_boxes*)> boxes(made, ancf_boxes_destroy);
    ancf_boxes_plan(made, m, 0, 0, 0);
    if (ancf_boxes_set(made, m) < 0) throw std::bad_alloc();
    std::array<ancf_nearest_pair, CableEngine::segmentsMost> places;
    int pairs;
    const ancf_meeting* meeting = ancf_boxes_meetings(made, &pairs);
    for (int k = 0; k < pairs; ++k) {
        const int e = meeting[k].first, f = meeting[k].second;
        const ancf_cover &p = cover[e], &q = cover[f];
        ancf_cubic first, second;
        ancf_cover_cubic(&first, m, m->x, e);
        ancf_cover_cubic(&second, m, m->x, f);
        const int n = ancf_nearest_cubic(places.data(), &first, p.segments, p.radius, &second, q.radius, 0);
        Overlap worst {cable.elementIds[e], cable.elementIds[f], {}, 0, std::min(p.radius, q.radius)};
        for (int i = 0; i < n; ++i)
            if (-places[i].gap > worst.depth && !ancf_cross_neighbours(&p, places[i].xi[0], m->element[e].length, &q,
                                                                       places[i].xi[1], m->element[f].length)) {
                worst.depth = -places[i].gap;
                worst.at = Vector3r(places[i].point[0]);
            }
        if (worst.depth > part * worst.radius) found.push_back(worst);
    }
}

vector<Overlap> CableCheck::overlaps(Real part) const {
    vector<Overlap> found;
    overlapsOfElements(found, part);
    overlapsOfCarried(found, part);
    crossings(found, part);
    return found;
}

} // namespace yade
