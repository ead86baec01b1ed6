// SPDX-License-Identifier: GPL-2.0-or-later
#include "CableGeom.hpp"

#include "CableNodes.hpp"
#include "Mobility.hpp"
#include "text.hpp"

#include <core/Interaction.hpp>
#include <core/Scene.hpp>

#include <array>

extern "C" {
#include "ancf/lying.h"
}

namespace yade {

YADE_PLUGIN((CarriedSphere)(CableGeom)(Law2_CableGeom_HollarsPhys_Hollars))
YADE_PLUGIN((Ig2_Sphere_CableElement_CableGeom)(Ig2_Box_CableElement_CableGeom)(Ig2_Facet_CableElement_CableGeom))
YADE_PLUGIN((Ig2_Wall_CableElement_CableGeom)(Ig2_Sheave_CableElement_CableGeom))
YADE_PLUGIN((Ig2_Sphere_CarriedSphere_CableGeom)(Ig2_Box_CarriedSphere_CableGeom)(Ig2_Facet_CarriedSphere_CableGeom))
YADE_PLUGIN((Ig2_Wall_CarriedSphere_CableGeom)(Ig2_Sheave_CarriedSphere_CableGeom))

namespace {
    constexpr Real stepsAhead = .75;  // what two may do in this many steps from the middle of one is looked for
    constexpr Real marginAhead = .05; // and this part of the cable's or sphere's radius besides

    Vector3r vectorOf(const double* p) { return Vector3r(p[0], p[1], p[2]); }

    void copy(double* to, const Vector3r& from) {
        for (int c = 0; c < 3; ++c) to[c] = from[c];
    }

    void setAxes(ancf_solid& s, const Quaternionr& ori) {
        const Matrix3r axes = ori.toRotationMatrix();
        for (int i = 0; i < 3; ++i) copy(s.axis[i], axes.col(i));
    }

    // Where a body will be a time from now, at its velocities of now.
    Se3r poseAhead(const Shape&, const State& state, Real time) {
        const bool turns = state.angVel != Vector3r::Zero();
        return Se3r(state.pos + time * state.vel, turns ? turned(time * state.angVel) * state.ori : state.ori);
    }

    Se3r poseAhead(const Sphere&, const State& state, Real time) {
        return Se3r(state.pos + time * state.vel, state.ori);
    }

    ancf_solid solidOf(const Sphere& sphere, const Se3r& pose) {
        ancf_solid s {};
        s.kind = ANCF_BALL;
        copy(s.center, pose.position);
        s.size[0] = sphere.radius;
        return s;
    }

    ancf_solid solidOf(const Box& box, const Se3r& pose) {
        ancf_solid s {};
        s.kind = ANCF_BOX;
        copy(s.center, pose.position);
        copy(s.size, box.extents);
        setAxes(s, pose.orientation);
        return s;
    }

    ancf_solid solidOf(const Facet& facet, const Se3r& pose) {
        ancf_solid s {};
        s.kind = ANCF_TRIANGLE;
        copy(s.center, pose.position);
        for (int i = 0; i < 3; ++i) copy(s.corner[i], pose.position + pose.orientation * facet.vertices[i]);
        return s;
    }

    ancf_solid solidOf(const Wall& wall, const Se3r& pose) {
        ancf_solid s {};
        s.kind = ANCF_PLANE;
        copy(s.center, pose.position);
        s.axis[0][wall.axis] = 1;
        s.sense = wall.sense;
        return s;
    }

    ancf_solid solidOf(const Sheave& sheave, const Se3r& pose) {
        ancf_solid s {};
        s.kind = ANCF_WHEEL;
        copy(s.center, pose.position);
        copy(s.axis[0], Sheave::axisOf(pose.orientation));
        s.groove = &sheave.groove();
        return s;
    }

    // Largest speed of a body's points within a distance.
    Real fastest(const State& state, Real distance) {
        const Real turning =
            state.angVel == Vector3r::Zero() || !std::isfinite(distance) ? 0 : state.angVel.norm() * distance;
        return state.vel.norm() + turning;
    }

    Real fastest(const ancf_model& m, int element) {
        int dof[4];
        ancf_model_dofs(dof, &m, element);
        const Real third = m.element[element].kind & ANCF_SPRING ? 0 : m.element[element].length / 3;
        Real ends[2];
        for (int k = 0; k < 2; ++k) {
            Vector3r node, slope;
            for (int c = 0; c < 3; ++c) {
                node[c] = m.v[c * m.stride + dof[2 * k]];
                slope[c] = m.v[c * m.stride + dof[2 * k + 1]];
            }
            ends[k] = node.norm() + third * slope.norm();
        }
        return std::max(ends[0], ends[1]);
    }

    bool accept(const shared_ptr<Interaction>& contact, const ancf_nearest* found, int n, Real radius1, Real radius2,
                bool ball) {
        if (n == 0 && !contact->geom) return false;
        const bool other = contact->geom && contact->geom->getClassIndex() != CableGeom::getClassIndexStatic();
        if (!contact->geom || other) contact->geom = shared_ptr<CableGeom>(new CableGeom);
        auto& geom = static_cast<CableGeom&>(*contact->geom);
        geom.edited = other || !geom.fits();
        geom.refR1 = radius1;
        geom.refR2 = radius2;
        geom.ball = ball;
        geom.set(found, n);
        return true;
    }

    // Pairs that never touch and do not now are left at once.
    bool passes(const Shape& shape2, const Interaction& contact) {
        return !contact.geom && static_cast<const CableElement&>(shape2).excludes(contact.getId1());
    }

    // Makes a place the mean of those that hold its segment, seen half a step later: how far it sinks in until then.
    void lieOn(ancf_nearest& place, const ancf_solid& solid, const CableView& view, int element,
               const ancf_cubic& cubic, const State& state, Real dt) {
        const Vector3r point = vectorOf(place.point),
                       speed = placeOf(view.model, view.model->v, element, place.xi) - velocityAt(state, point);
        const ancf_cover& cover = view.cover[element];
        ancf_lying_on(&place, &cubic, cover.segments, cover.radius, &solid,
                      std::max(-dt / 2 * vectorOf(place.normal).dot(speed), Real(0)));
    }

    // The way of a sphere in the middle of the step against the mean of the cable's nodes.
    Vector3r placeAgainstMean(const CableView& view, const State& state, Real dt) {
        return state.pos + dt / 2 * state.vel - vectorOf(view.motion->mean_way);
    }

    // The sphere's entry, if the element's motion is known.
    Resting* restingOf(const CableView& view, const Scene& scene, const Interaction& contact) {
        view.asked.store(true, std::memory_order_relaxed);
        const size_t i = static_cast<size_t>(contact.linIx);
        const bool known = view.followed && i < view.resting.size() && view.motion->step == scene.dt;
        return known ? &view.resting[i] : nullptr;
    }

    bool rests(const Resting& pair, const CableView& view, int element, const Interaction& contact, Real radius,
               const State& state, Real dt) {
        if (pair.epoch != view.epoch || pair.ids[0] != contact.getId1() || pair.ids[1] != contact.getId2() ||
            pair.radius != radius)
            return false;
        const ancf_motion& m = *view.motion;
        const Real way = (placeAgainstMean(view, state, dt) - pair.place).norm() + m.gone[element],
                   speed = state.vel.norm() + m.speed[element] + vectorOf(m.mean_velocity).norm();
        return way + stepsAhead * dt * speed < pair.wake;
    }

    // Lets a pair that was not found near rest for as long as it can.
    void letRest(Resting& pair, const CableView& view, int element, const Interaction& contact, const Sphere& sphere,
                 const State& state, Real dt) {
        ancf_cubic cubic;
        ancf_cover_ahead(&cubic, view.model, element, dt / 2);
        const Vector3r center = state.pos + dt / 2 * state.vel;
        const Real radius = view.cover[element].radius,
                   gap = ancf_nearest_least(&cubic, center.data()) - radius - sphere.radius;
        pair.epoch = view.epoch;
        pair.ids[0] = contact.getId1();
        pair.ids[1] = contact.getId2();
        pair.radius = sphere.radius;
        pair.place = placeAgainstMean(view, state, dt);
        pair.wake = gap - 2 * marginAhead * radius + view.motion->gone[element]; // one margin is room for rounding
    }

    bool nearCable(const Scene& scene, const ancf_solid& solid, const State& state, Real radius, const Shape& shape2,
                   const shared_ptr<Interaction>& contact) {
        constexpr int most = 65;
        std::array<ancf_nearest, most> found;
        const auto& element = static_cast<const CableElement&>(shape2);
        const CableView* view = element.view(scene);
        if (!view) return accept(contact, found.data(), 0, 0, 0, false);
        const ancf_cover& cover = view->cover[element.element];
        int n = 0;
        const bool wound = view->model->element[element.element].kind & ANCF_WOUND;
        if (!wound && !element.excludes(contact->getId1())) {
            ancf_cubic cubic;
            ancf_cover_ahead(&cubic, view->model, element.element, scene.dt / 2);
            const Real speed = fastest(state, ancf_solid_reach(&solid)) + fastest(*view->model, element.element);
            const Real reach = stepsAhead * scene.dt * speed + marginAhead * cover.radius;
            n = ancf_cover_touch(found.data(), &cover, &cubic, &solid, reach);
            for (int i = 0; i < n && !cover.points; ++i)
                lieOn(found[i], solid, *view, element.element, cubic, state, scene.dt);
        }
        return accept(contact, found.data(), n, radius > 0 ? radius : cover.radius, cover.radius,
                      solid.kind == ANCF_BALL);
    }

    bool nearSphere(const Scene& scene, const ancf_solid& solid, const State& state, Real radius, const Shape& shape2,
                    const State& state2, const shared_ptr<Interaction>& contact) {
        const Real own = static_cast<const Sphere&>(shape2).radius;
        ancf_nearest found {};
        copy(found.point, state2.pos + scene.dt / 2 * state2.vel);
        found.gap = ancf_solid_distance(found.normal, &solid, found.point) - own;
        found.share = 1;
        const Real speed = fastest(state, ancf_solid_reach(&solid)) + fastest(state2, own);
        const bool near = found.gap < stepsAhead * scene.dt * speed + marginAhead * own;
        return accept(contact, &found, near ? 1 : 0, radius > 0 ? radius : own, own, solid.kind == ANCF_BALL);
    }
} // namespace

bool solidOf(ancf_solid& solid, const Body& body) {
    const Shape* shape = body.shape.get();
    const Se3r& pose = body.state->se3;
    if (const auto* sphere = dynamic_cast<const Sphere*>(shape)) solid = solidOf(*sphere, pose);
    else if (const auto* box = dynamic_cast<const Box*>(shape)) solid = solidOf(*box, pose);
    else if (const auto* facet = dynamic_cast<const Facet*>(shape)) solid = solidOf(*facet, pose);
    else if (const auto* wall = dynamic_cast<const Wall*>(shape)) solid = solidOf(*wall, pose);
    else if (const auto* sheave = dynamic_cast<const Sheave*>(shape)) solid = solidOf(*sheave, pose);
    else return false;
    return true;
}

bool CableGeom::fits() const {
    const size_t n = xi.size();
    return segment.size() == n && gap.size() == n && point.size() == n && normals.size() == n && force.size() == n &&
           friction.size() == n && owed.size() == n && late.size() == n && powers.size() == n &&
           powersLast.size() == n && share.size() == n;
}

void CableGeom::set(const ancf_nearest* found, int n) {
    const vector<int> before = edited ? vector<int>() : segment;
    const vector<Vector3r> kept = friction, keptLate = late, keptPowers = powers;
    const vector<Real> keptOwed = owed;
    const size_t size = static_cast<size_t>(n);
    segment.resize(size);
    xi.resize(size);
    gap.resize(size);
    point.resize(size);
    normals.resize(size);
    force.assign(size, 0);
    friction.assign(size, Vector3r::Zero());
    late.assign(size, Vector3r::Zero());
    owed.assign(size, 0);
    powers.resize(size);
    powersLast.assign(size, Vector3r::Zero());
    share.resize(size);
    size_t nearest = 0;
    for (size_t i = 0, old = 0; i < size; ++i) {
        segment[i] = found[i].segment;
        xi[i] = found[i].xi;
        powers[i] = vectorOf(found[i].power);
        share[i] = found[i].share;
        gap[i] = found[i].gap;
        point[i] = vectorOf(found[i].point);
        normals[i] = vectorOf(found[i].normal);
        while (old < before.size() && before[old] < segment[i]) ++old;
        if (old < before.size() && before[old] == segment[i]) {
            friction[i] = kept[old];
            late[i] = keptLate[old];
            owed[i] = keptOwed[old];
            powersLast[i] = keptPowers[old];
        }
        if (gap[i] < gap[nearest]) nearest = i;
    }
    if (n == 0) return;
    normal = normals[nearest];
    contactPoint = point[nearest] - (refR2 + gap[nearest] / 2) * normal;
}

#define ANCF_NEAR_CABLE(Kind, radius)                                                                                  \
    bool Ig2_##Kind##_CableElement_CableGeom::go(const shared_ptr<Shape>& shape1, const shared_ptr<Shape>& shape2,     \
                                                 const State& state1, const State&, const Vector3r&, const bool&,      \
                                                 const shared_ptr<Interaction>& contact) {                             \
        if (passes(*shape2, *contact)) return false;                                                                   \
        const auto& first = static_cast<const Kind&>(*shape1);                                                         \
        return nearCable(*scene, solidOf(first, poseAhead(first, state1, scene->dt / 2)), state1, radius, *shape2,     \
                         contact);                                                                                     \
    }
#define ANCF_NEAR_SPHERE(Kind, radius)                                                                                 \
    bool Ig2_##Kind##_CarriedSphere_CableGeom::go(const shared_ptr<Shape>& shape1, const shared_ptr<Shape>& shape2,    \
                                                  const State& state1, const State& state2, const Vector3r&,           \
                                                  const bool&, const shared_ptr<Interaction>& contact) {               \
        const auto& first = static_cast<const Kind&>(*shape1);                                                         \
        const ancf_solid solid = solidOf(first, poseAhead(first, state1, scene->dt / 2));                              \
        return nearSphere(*scene, solid, state1, radius, *shape2, state2, contact);                                    \
    }
#define ANCF_NEAR(Kind, radius) ANCF_NEAR_CABLE(Kind, radius) ANCF_NEAR_SPHERE(Kind, radius)

ANCF_NEAR_SPHERE(Sphere, first.radius)
// YADE fills its table of functors for a derived shape, as that of a sphere on a knot, while other threads read it: one
// of them may get the functor before it is told that the bodies are to be swapped.
bool Ig2_Sphere_CableElement_CableGeom::go(const shared_ptr<Shape>& shape1, const shared_ptr<Shape>& shape2,
                                           const State& state1, const State& state2, const Vector3r& shift,
                                           const bool& force, const shared_ptr<Interaction>& contact) {
    if (shape2->getClassIndex() != CableElement::getClassIndexStatic()) {
        contact->swapOrder();
        return go(shape2, shape1, state2, state1, -shift, force, contact);
    }
    if (passes(*shape2, *contact)) return false;
    const auto& sphere = static_cast<const Sphere&>(*shape1);
    const auto& element = static_cast<const CableElement&>(*shape2);
    const CableView* view = contact->geom ? nullptr : element.view(*scene);
    Resting* pair = view ? restingOf(*view, *scene, *contact) : nullptr;
    if (pair && rests(*pair, *view, element.element, *contact, sphere.radius, state1, scene->dt)) return false;
    const ancf_solid solid = solidOf(sphere, poseAhead(sphere, state1, scene->dt / 2));
    if (nearCable(*scene, solid, state1, sphere.radius, *shape2, contact)) return true;
    if (pair) letRest(*pair, *view, element.element, *contact, sphere, state1, scene->dt);
    return false;
}

ANCF_NEAR(Box, (static_cast<void>(first), 0))
ANCF_NEAR(Facet, (static_cast<void>(first), 0))
ANCF_NEAR(Wall, (static_cast<void>(first), 0))
ANCF_NEAR(Sheave, first.radius)

void Law2_CableGeom_HollarsPhys_Hollars::setAttribute(const py::object& self, const string& name,
                                                      const py::object& value) {
    const bool engines = name == "normal" || name == "friction";
    const py::object type(py::handle<>(PyObject_Type(self.ptr())));
    if (!PyObject_HasAttrString(type.ptr(), name.c_str())) {
        const string why = text("Law2_CableGeom_HollarsPhys_Hollars has no attribute ", name, ": contacts of cables ",
                                engines ? text("follow CableEngine.", name, ", set that")
                                        : "follow the attributes of their CableEngine");
        PyErr_SetString(PyExc_AttributeError, why.c_str());
        py::throw_error_already_set();
    }
    if (PyObject_GenericSetAttr(self.ptr(), py::str(name).ptr(), value.ptr())) py::throw_error_already_set();
}

bool Law2_CableGeom_HollarsPhys_Hollars::go(shared_ptr<IGeom>& geom, shared_ptr<IPhys>& phys, Interaction*) {
    if (!static_cast<const CableGeom&>(*geom).xi.empty()) return true;
    auto& ended = static_cast<HollarsPhys&>(*phys);
    ended.kn = ended.ks = 0;
    ended.normalForce = ended.shearForce = Vector3r::Zero();
    return false;
}

} // namespace yade
