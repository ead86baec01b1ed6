// SPDX-License-Identifier: GPL-2.0-or-later
#include "CableContacts.hpp"

#include "CableEngine.hpp"
#include "CableGeom.hpp"
#include "CableNodes.hpp"
#include "Drive.hpp"
#include "MaterialWatch.hpp"
#include "text.hpp"

#include <core/Clump.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

namespace yade {

namespace {
    constexpr int substepsMost = 5000; // of contacts in a step
    constexpr Real unsolved = .1;      // part of the largest force by which one may be off
    constexpr int restingSteps = 100;  // of the cable, that an element should be able to move before it leaves its box
    constexpr Real stepsAhead = 2.5;   // more than what the functors look for, as speeds grow until boxes are new
    constexpr Real marginAhead = .05;  // and this part of the radius besides

    Vector3r vectorOf(const Real* p) { return Vector3r(p[0], p[1], p[2]); }

    void copy(Real* to, const Vector3r& from) {
        for (int c = 0; c < 3; ++c) to[c] = from[c];
    }

    CableGeom* geomOf(const Interaction& contact) {
        const bool is = contact.isReal() && contact.geom->getClassIndex() == CableGeom::getClassIndexStatic();
        return is ? static_cast<CableGeom*>(contact.geom.get()) : nullptr;
    }

    // Distance of a place that is the mean of several from a ball's centre, less the gap, in the middle of the step.
    Real heldOf(const CableGeom& geom, size_t i, const State& ball, Real dt) {
        return (geom.point[i] - ball.pos - dt / 2 * ball.vel).norm() - geom.gap[i];
    }

    void outOfMemory() { throw std::bad_alloc(); }

    int added(int number) {
        if (number < 0) outOfMemory();
        return number;
    }
} // namespace

// ---------------------------------------------------------------- made, once

void CableContacts::reset(std::shared_ptr<const void> model) {
    table.reset();
    apart.reset();
    awake.clear();
    outgrown = true;
    if (!shown->model) return;
    shown->outdated.store(true);
    views.push_back(shown);
    parts.insert(parts.end(), {std::move(boxes), std::move(motion)});
    keep(std::move(model)); // all of it goes, if nobody reads
    shown.reset(new CableView(inUse));
}

// Functors first say that they read, then look whether there is a new view; here it is the other way round.
void CableContacts::keep(std::shared_ptr<const void> part) {
    parts.push_back(std::move(part));
    if (inUse->load()) return;
    parts.clear();
    for (const auto& view : views) vector<ancf_cover>().swap(view->cover);
}

void CableContacts::stepBegins() {
    inUse->store(false);
    if (views.empty() && parts.empty()) return;
    parts.clear();
    views.clear();
}

void CableContacts::disturb() {
    outgrown = true;
    ++shown->epoch;
}

void CableContacts::makeCover(const CableEngine& cable) {
    const ancf_model* m = cable.theModel();
    const size_t n = cable.length.size();
    auto& cover = shown->cover;
    cover.assign(n, ancf_cover {});
    std::map<std::pair<const Material*, Real>, int> kindOf;
    covers.clear();
    vector<bool> owned(static_cast<size_t>(m->n_nodes), false);
    for (size_t e = 0; e < n; ++e) {
        ancf_cover& c = cover[e];
        c.segments = 1;
        if (cable.elementIds[e] < 0) continue;
        cable.checkElementBody(static_cast<int>(e));
        const Body& body = cable.elementBody(static_cast<int>(e));
        c.radius = cable.radius[e];
        c.segments = cable.segments[e];
        c.points = cable.points[e] != 0;
        const auto [kind, fresh] = kindOf.insert({{body.material.get(), c.radius}, static_cast<int>(kindOf.size())});
        c.kind = kind->second;
        if (fresh) covers.emplace_back(body.material, c.radius);
        c.mask = cable.kind[e] & ANCF_WOUND ? 0 : static_cast<int>(body.groupMask) & ~CableElement::allHave;
        c.structure = cable.structure[e];
        c.own = cable.selfContact[e] != 0;
        c.run = cable.run[e];
        c.arc = cable.arc[e];
        c.closed = cable.closed[e];
        for (int k = 0; k < 2; ++k) {
            c.owns[k] = !owned[m->ends[2 * e + k]];
            owned[m->ends[2 * e + k]] = true;
        }
    }
    kinds = static_cast<int>(kindOf.size());
    mixLaws(cable);
}

void CableContacts::mixLaws(const CableEngine& cable) {
    const size_t n = covers.size();
    laws.assign(n * n, ancf_laws {});
    for (const auto& [material, radius] : covers) {
        if (!dynamic_cast<const HollarsMat*>(material.get()))
            cable.refuse("the material of a cable's body must be a HollarsMat");
        MaterialWatch::instance().add(material);
    }
    for (size_t i = 0; i < n * n; ++i) {
        const auto& [first, r1] = covers[i / n];
        const auto& [second, r2] = covers[i % n];
        HollarsPhys phys;
        mixHollars(phys, static_cast<const HollarsMat&>(*first), static_cast<const HollarsMat&>(*second),
                   1 / (1 / r1 + 1 / r2), frictionRuleOf(cable.theScene(), *first, *second));
        phys.normalKind = cable.normalKind;
        phys.frictionKind = cable.frictionKind;
        if (const string fault = lawFault(phys, first.get(), second.get(), 1); !fault.empty())
            cable.refuse(
                text("the contact of its cables of materials '", first->label, "' and '", second->label, "': ", fault));
        laws[i] = {phys.normalLaw(), phys.frictionLaw()};
    }
    edition = MaterialWatch::instance().edition();
}

void CableContacts::build(CableEngine& cable) {
    const ancf_model* m = cable.theModel();
    makeCover(cable);
    ancf_table* newTable = nullptr;
    ancf_boxes* newBoxes = nullptr;
    if (ancf_table_create(&newTable, m)) outOfMemory();
    table.reset(newTable);
    if (ancf_boxes_create(&newBoxes, m, shown->cover.data())) outOfMemory();
    boxes.reset(newBoxes);
    ancf_motion* newMotion = nullptr;
    if (ancf_motion_create(&newMotion, m)) outOfMemory();
    motion.reset(newMotion);
    ancf_apart* newApart = nullptr;
    if (ancf_apart_create(&newApart, m, shown->cover.data(), motion.get())) outOfMemory();
    apart.reset(newApart);
    plan(cable);
    shown->boxes = boxes.get();
    shown->motion = motion.get();
    shown->model = m;
    shown->followed = false;
    ++shown->epoch;
    outgrown = true;
    cable.theScene().doSort = true; // the collider has not seen these boxes
}

// ---------------------------------------------------------------- where contact can be

// How large the boxes are: for some steps at the speeds of now, and what else moves as fast as it does.
void CableContacts::plan(const CableEngine& cable) {
    const Scene& s = cable.theScene();
    Real fastest = 0, thickest = 0;
    for (const auto& body : *s.bodies)
        if (!CableElement::of(*body)) fastest = std::max(fastest, body->state->vel.squaredNorm());
    for (const ancf_cover& c : shown->cover) thickest = std::max(thickest, c.radius);
    const Real speed = std::sqrt(fastest) + ancf_boxes_fastest(cable.theModel());
    const Real ahead = stepsAhead * s.dt * speed + marginAhead * thickest;
    ancf_boxes_plan(boxes.get(), cable.theModel(), s.dt / std::max(1, cable.substeps), restingSteps, ahead);
    plannedStep = s.dt;
}

void CableContacts::planFor(const CableEngine& cable, Real step) {
    if (step != plannedStep) plan(cable);
}

// After the collider has run: the boxes are those of now, and only elements in an interaction are looked at until then.
void CableContacts::lookAround(const CableEngine& cable) {
    if (kinds == 0) return; // no element touches anything
    const Scene& s = *cable.scene;
    const bool ran = [&] {
        for (const Body::id_t id : cable.elementIds)
            if (id >= 0 && (*s.bodies)[id]) {
                const auto& bound = (*s.bodies)[id]->bound;
                return bound && bound->lastUpdateIter == s.iter;
            }
        return false;
    }();
    if (!outgrown && !ran) return;
    if (ancf_boxes_set(boxes.get(), cable.theModel()) < 0) outOfMemory();
    windows = ancf_apart_set(apart.get(), boxes.get(), cable.theModel());
    if (windows < 0) outOfMemory();
    placeBodies(cable);
    awake.clear();
    for (int e = 0; e < cable.nElements(); ++e)
        if (cable.elementIds[e] >= 0 && !(cable.kind[e] & ANCF_WOUND) &&
            !(cable.sleep && cable.elementBody(e).intrs.empty()))
            awake.push_back(e);
}

void CableContacts::placeBodies(const CableEngine& cable) const {
    for (int e = 0; e < cable.nElements(); ++e) {
        if (cable.elementIds[e] < 0) continue;
        const Body& body = cable.elementBody(e);
        Real middle[3];
        ancf_model_at(middle, cable.theModel(), cable.theModel()->x, e, .5);
        body.state->pos = vectorOf(middle);
        if (body.bound) body.bound->refPos = body.state->pos; // an integrator that visits it sees no way
    }
}

int CableContacts::asleep(const CableEngine& cable) const {
    const auto bodies = std::count_if(cable.elementIds.begin(), cable.elementIds.end(), [](int id) { return id >= 0; });
    return static_cast<int>(bodies) - static_cast<int>(awake.size());
}

// ---------------------------------------------------------------- gathered

// The body as it will move without the cables' forces.
int CableContacts::addBody(const CableEngine& cable, const Body& body) {
    if (stamp[body.id] == gathered) return entryOfBody[body.id];
    Scene& s = *cable.scene;
    const State& state = *body.state;
    const Mobility m = mobility(s, body);
    const int carrier = cable.carrierOf(body.id);
    Vector3r vel = state.vel, spin = state.angVel, force = Vector3r::Zero(), torque = Vector3r::Zero();
    if (m.movable()) forceOn(s, body, force, torque);
    if (drivenBody(s, body)) {
        eachDrive(s, [&](const Drive& drive) { drive.predict(vel, spin, s, body, force, torque); });
    } else if (m.movable()) {
        for (int c = 0; c < 3; ++c)
            if (m.inverseMass[c] > 0) vel[c] += s.dt * (m.inverseMass[c] * force[c] + cable.gravity[c]);
        if (body.isAspherical()) {
            const Vector3r local = state.ori.conjugate() * state.angVel;
            torque -= state.angVel.cross(state.ori * state.inertia.cwiseProduct(local));
        }
        spin += s.dt * (m.inverseInertia * torque);
    }
    Vector3r before = state.vel;
    if (carrier >= 0) before = vel = Vector3r::Zero(); // its knot moves it
    const Vector3r acceleration = (vel - before) / s.dt, turning = (spin - state.angVel) / s.dt;
    ancf_body b {};
    copy(b.position, state.pos);
    copy(b.velocity, vel + untilFirst * acceleration);
    copy(b.spin, spin + untilFirst * turning);
    copy(b.acceleration, acceleration);
    copy(b.turning, turning);
    copy(b.inv_mass, carrier >= 0 ? Vector3r(Vector3r::Zero()) : m.inverseMass);
    copy(b.along, m.along);
    for (int c = 0; c < 3; ++c) copy(b.inv_inertia + 3 * c, m.inverseInertia.row(c));
    entries.push_back({body.id, spin, carrier});
    stamp[body.id] = gathered;
    return entryOfBody[body.id] = added(ancf_table_add_body(table.get(), &b));
}

ancf_side CableContacts::sideOf(const CableEngine& cable, const Body& touched, const Vector3r& at) {
    const Body& body = movedBody(*cable.scene, touched);
    ancf_side side {-1, addBody(cable, body), {0, 0, 0}};
    copy(side.arm, at - body.state->pos);
    const int carrier = entries[side.body].carrier;
    if (carrier < 0) return side;
    int& knot = knotOfCarrier[carrier];
    if (knot < 0) knot = added(ancf_table_add_knot(table.get(), cable.theModel(), cable.carryNodes[carrier]));
    side.place = knot;
    return side;
}

// element: that of the second body, or -1 for a sphere that a knot carries.
void CableContacts::addContact(const CableEngine& cable, const Interaction& contact, int element) {
    CableGeom* geom = geomOf(contact);
    if (!geom || geom->xi.empty()) return;
    const auto refuse = [&](const string& fault) {
        cable.refuse(text("the contact of bodies ", contact.getId1(), " and ", contact.getId2(), ": ", fault));
    };
    if (!isHollars(*contact.phys))
        refuse(text("phys is a ", contact.phys->getClassName(), ": must be the HollarsPhys that it was"));
    if (geom->edited || !geom->fits())
        refuse("geom was edited: its lists must be those of one CableGeom, of one length");
    auto* phys = static_cast<HollarsPhys*>(contact.phys.get());
    followMaterials(*phys, *cable.scene, contact);
    phys->normalKind = cable.normalKind;
    phys->frictionKind = cable.frictionKind;
    const Body &first = *(*cable.scene->bodies)[contact.getId1()], &second = *(*cable.scene->bodies)[contact.getId2()];
    if (const string fault =
            lawFault(*phys, first.material.get(), second.material.get(), std::numeric_limits<Real>::quiet_NaN());
        !fault.empty())
        refuse(fault);
    const ancf_model* m = cable.theModel();
    Row row {geom, phys, ancf_table_contacts(table.get()), 0, contact.getId1(), contact.getId2()};
    for (size_t i = 0; i < geom->xi.size(); ++i) {
        ancf_contact c {};
        c.law = c.plain = phys->normalLaw();
        c.rub = phys->frictionLaw();
        const Vector3r normal = geom->normals[i];
        Vector3r at, speed; // of the first side, where forces act: on a cable at its centreline, as it has no twist
        if (element >= 0) {
            const ancf_cover& cover = shown->cover[element];
            const Vector3r& power = geom->powers[i];
            c.side[0] = {added(ancf_table_add_mean(table.get(), m, element, power.data())), -1, {0, 0, 0}};
            for (int k = 0; k < 2; ++k)
                c.within[k] = cover.points ? geom->xi[i] : Real(geom->segment[i] + k) / cover.segments;
            at = meanOf(m, m->x, element, power);
            speed = meanOf(m, m->v, element, power);
            c.law = ancf_normal_shared(&c.plain, geom->share[i]);
        } else {
            at = second.state->pos - (geom->refR2 + geom->gap[i] / 2) * normal;
            speed = velocityAt(*second.state, at);
            c.side[0] = sideOf(cable, second, at);
        }
        c.side[1] = sideOf(cable, first, at);
        copy(c.normal, normal);
        c.margin = marginAhead * geom->refR2;
        if (geom->ball && !first.isClumpMember()) {
            c.round = geom->refR1 + geom->refR2;
            c.held = geom->lies(i) ? heldOf(*geom, i, *first.state, cable.scene->dt) : c.round;
        }
        copy(c.friction, geom->friction[i]);
        Vector3r changing = Vector3r::Zero(); // of cables alone: bodies' accelerations change less
        for (int side = 0; side < 2; ++side) {
            if (c.side[side].place < 0) continue;
            const ancf_place& place = *ancf_table_place(table.get(), c.side[side].place);
            changing += side == 0 && element >= 0
                            ? meanOf(m, m->a, element, geom->powersLast[i])
                            : Vector3r((side ? -1 : 1) * placeOf(m, m->a, place.element, place.xi));
        }
        c.owed = ancf_owed(geom->owed[i], geom->late[i].data(), changing.data());
        // The gap at the start of the step: found for its middle, at the velocities of now.
        c.gap = geom->gap[i] - cable.scene->dt / 2 * normal.dot(speed - velocityAt(*first.state, at));
        added(ancf_table_add_contact(table.get(), &c));
    }
    row.end = ancf_table_contacts(table.get());
    rows.push_back(row);
}

// Contacts of elements that are looked at, then of spheres that knots carry (element -1), until `found` says so.
template <class F> bool CableContacts::find(const CableEngine& cable, F found) const {
    for (const int e : awake)
        for (const auto& [id, contact] : cable.elementBody(e).intrs)
            if (found(*contact, e)) return true;
    const auto ofSphere = [&](const Body& body) {
        if (!CarriedSphere::is(body)) return false;
        for (const auto& [id, contact] : body.intrs)
            if (contact->getId2() == body.id && found(*contact, -1)) return true;
        return false;
    };
    for (const Body::id_t id : cable.carryIds) {
        const Body& body = *(*cable.scene->bodies)[id];
        if (ofSphere(body)) return true;
        if (body.isClump())
            for (const auto& member : static_cast<const Clump&>(*body.shape).members)
                if (ofSphere(*(*cable.scene->bodies)[member.first])) return true;
    }
    return false;
}

void CableContacts::addCouplings(const CableEngine& cable) {
    for (size_t i = 0; i < cable.carryIds.size(); ++i) {
        if (cable.carrierOf(cable.carryIds[i]) >= 0) continue;
        const Body& body = *(*cable.scene->bodies)[cable.carryIds[i]];
        ancf_coupling c {};
        c.body = addBody(cable, body);
        c.place = added(ancf_table_add_knot(table.get(), cable.theModel(), cable.carryNodes[i]));
        const Vector3r arm = body.state->ori * cable.carryAt[i], spin = entries[c.body].spinBefore;
        copy(c.arm, arm);
        copy(c.ahead, .5 * cable.scene->dt * spin.cross(spin.cross(arm)));
        added(ancf_table_add_coupling(table.get(), &c));
    }
}

void CableContacts::addCrossings(CableEngine& cable) {
    const ancf_model* m = cable.theModel();
    firstCrossing = ancf_table_contacts(table.get());
    if (windows == 0) return;
    ancf_motion_follow(motion.get(), m, cable.scene->dt);
    added(ancf_cross_add(table.get(), apart.get(), shown->cover.data(), m, laws.data(), kinds, cable.scene->dt,
                         memory.data(), static_cast<int>(memory.size())));
}

bool CableContacts::begin(const CableEngine& cable, int steps) {
    untilFirst = -.5 * (steps - 1) * cable.scene->dt / steps;
    ancf_table_clear(table.get());
    ++gathered;
    entries.clear();
    rows.clear();
    firstCrossing = 0;
    const size_t bodies = cable.scene->bodies->size();
    if (stamp.size() < bodies) stamp.resize(bodies, -1);
    if (entryOfBody.size() < bodies) entryOfBody.resize(bodies);
    knotOfCarrier.assign(cable.carryIds.size(), -1);
    lookAround(cable);
    return windows > 0 || cable.anyCoupled || find(cable, [](const Interaction& contact, int) {
               const CableGeom* geom = geomOf(contact);
               return geom && !geom->xi.empty();
           });
}

void CableContacts::gather(CableEngine& cable) {
    MaterialWatch::instance().look();
    if (edition != MaterialWatch::instance().edition()) mixLaws(cable);
    addCouplings(cable);
    find(cable, [&](const Interaction& contact, int element) {
        addContact(cable, contact, element);
        return false;
    });
    addCrossings(cable);
}

// ---------------------------------------------------------------- solved

void CableContacts::solve(CableEngine& cable, const ancf_time& time, int step, int steps) {
    ancf_model* m = cable.theModel();
    ancf_table* t = table.get();
    if (step == 0) {
        cable.contactSteps = cable.sweeps = 0;
        cable.normalLeft = cable.frictionLeft = 0;
        acted = false;
    }
    velocity = m->free;
    way = nullptr;
    if (ancf_table_contacts(t) == 0 && !cable.coupled()) return;
    if (step == 0) {
        ancf_table_rest(t, m, m->free, time.step, untilFirst);
        if (ancf_table_prepare(t, m, m->free)) outOfMemory();
        ancf_table_accelerate(t, m, m->a);
    } else if (ancf_table_go_on(t, m, m->free, time.step)) {
        outOfMemory();
    }
    if (ancf_table_awake(t) == 0 && !cable.coupled()) {
        ancf_table_end(t, time.step);
        return;
    }
    acted = true;
    const size_t size = cable.position.size();
    after.resize(size);
    shift.resize(size);
    std::memcpy(after.data(), m->free, size * sizeof(Real));
    std::memset(shift.data(), 0, size * sizeof(Real));
    velocity = after.data();
    way = shift.data();
    ancf_table_guess(t, time.step);
    ancf_table_couple(t, time.step);
    int stiffest = 0;
    const int needed = ancf_table_substeps(t, time.step, &stiffest);
    if (needed > substepsMost)
        cable.refuse(text("at iteration ", cable.scene->iter, " ", nameOf(pairOf(stiffest)), " would need ", needed,
                          " sub-steps in ", time.step,
                          " s: it is too stiff, or what touches too light or too fast; use O.dt <= ",
                          steps * time.step * substepsMost / needed));
    const Real pressLeft = ancf_table_press(t, time.step, needed);
    Real rubLeft = 0;
    const int sweeps = ancf_table_rub(t, time.step, &rubLeft);
    if (!(pressLeft <= unsolved))
        cable.refuse(text("at iteration ", cable.scene->iter, " the normal forces of contacts could not be solved, ",
                          pressLeft, " of the largest is left; the stiffest is ", nameOf(pairOf(stiffest)),
                          "; use O.dt < ", steps * time.step, " s, or masses and stiffnesses that differ less"));
    if (sweeps > 0) ancf_table_couple(t, time.step);
    ancf_table_apply(t, m, time.step, after.data(), shift.data());
    ancf_table_end(t, time.step);
    cable.contactSteps += needed;
    cable.sweeps = std::max(cable.sweeps, sweeps);
    cable.normalLeft = std::max(cable.normalLeft, pressLeft);
    cable.frictionLeft = std::max(cable.frictionLeft, rubLeft);
    if (!(rubLeft <= unsolved)) ++cable.frictionUnsolved;
}

CableContacts::Pair CableContacts::pairOf(int contact) const {
    for (const Row& row : rows)
        if (contact >= row.begin && contact < row.end) return {row.first, row.second, false};
    const ancf_contact* c = ancf_table_contact(table.get(), contact);
    return {c->key[0], c->key[1], true};
}

string CableContacts::nameOf(const Pair& pair) {
    return text("the contact of ", pair.elements ? "the elements " : "bodies ", pair.first, " and ", pair.second);
}

// ---------------------------------------------------------------- given back

// Forces to the bodies, for whoever integrates them; the rest of what moved them within the step to their places.
void CableContacts::giveBodies(const CableEngine& cable, Real passed) {
    Scene& s = *cable.scene;
    lifted = 0;
    for (size_t i = 0; i < entries.size(); ++i) {
        const ancf_body& b = *ancf_table_body(table.get(), static_cast<int>(i));
        const Body& body = *(*s.bodies)[entries[i].id];
        const Vector3r impulse = vectorOf(b.impulse), twist = vectorOf(b.twist);
        if (impulse == Vector3r::Zero() && twist == Vector3r::Zero()) continue;
        const bool driven = drivenBody(s, body);
        const Vector3r turn = vectorOf(b.turned) - s.dt * (vectorOf(b.spin) - passed * vectorOf(b.given + 3));
        if (!driven && turn != Vector3r::Zero()) body.state->ori = turned(turn) * body.state->ori;
        const bool carried = entries[i].carrier >= 0; // what moves it, its knot takes
        const Left left =
            addExactly(s, body, body, carried ? Vector3r(Vector3r::Zero()) : Vector3r(impulse / s.dt), twist / s.dt);
        if (!driven && !body.isAspherical()) // what rounding left, so that momentum is kept to the last bit
            for (int c = 0; c < 3; ++c) body.state->angVel[c] += s.dt * b.inv_inertia[4 * c] * left.torque[c];
        if (carried) continue;
        if (!driven)
            for (int c = 0; c < 3; ++c) body.state->vel[c] += s.dt * b.inv_mass[c] * left.force[c];
        const Vector3r more = vectorOf(b.moved) - s.dt * (vectorOf(b.velocity) - passed * vectorOf(b.given));
        body.state->pos += more;
        lifted -= body.state->mass * cable.gravity.dot(more);
    }
}

// Forces to the contacts of YADE, for whoever reads them.
void CableContacts::giveRows(const CableEngine& cable) const {
    const Real dt = cable.scene->dt;
    for (const Row& row : rows) {
        Vector3r normal = Vector3r::Zero(), friction = Vector3r::Zero();
        row.phys->kn = row.phys->ks = 0;
        for (int i = row.begin; i < row.end; ++i) {
            const ancf_contact& c = *ancf_table_contact(table.get(), i);
            const Vector3r pressed = vectorOf(c.pressed) / dt;
            const Real force = pressed.norm();
            row.geom->friction[static_cast<size_t>(i - row.begin)] = vectorOf(c.friction);
            row.geom->force[static_cast<size_t>(i - row.begin)] = force;
            row.geom->late[static_cast<size_t>(i - row.begin)] = vectorOf(c.late);
            row.geom->owed[static_cast<size_t>(i - row.begin)] = c.owed;
            friction += vectorOf(c.dragged) / dt;
            normal += pressed;
            row.phys->kn += ancf_normal_tangent(&c.law, c.depth);
            row.phys->ks += force * ancf_friction_slope(&c.rub) / dt;
        }
        row.phys->normalForce = normal;
        row.phys->shearForce = friction;
    }
}

void CableContacts::give(CableEngine& cable, const ancf_time& time) {
    const Real passed = -untilFirst; // of the last step in O.dt, as the first is as far before its middle
    ancf_model* m = cable.theModel();
    ancf_table* t = table.get();
    const int n = ancf_table_contacts(t);
    memory.resize(static_cast<size_t>(n - firstCrossing));
    memory.resize(static_cast<size_t>(ancf_cross_keep(memory.data(), t, firstCrossing, n)));
    cable.contacts = 0;
    if (!acted) {
        lifted = 0;
        giveRows(cable);
        for (size_t i = 0; i < cable.carryIds.size(); ++i) cable.setCarryReaction(i, Vector3r::Zero());
        return;
    }
    giveBodies(cable, passed);
    giveRows(cable);
    Real twist[3];
    ancf_table_twist_left(twist, t);
    cable.twistLeft += vectorOf(twist);
    for (int i = 0; i < n; ++i) {
        const ancf_contact& c = *ancf_table_contact(t, i);
        cable.contacts += vectorOf(c.pressed) != Vector3r::Zero();
        cable.maxPenetration = std::max(cable.maxPenetration, c.depth);
    }
    ancf_table_forces(t, m, ancf_kick(&time), m->f); // what the reactions are found from
    int coupling = 0;
    for (size_t i = 0; i < cable.carryIds.size(); ++i) {
        if (cable.carrierOf(cable.carryIds[i]) < 0) {
            const ancf_coupling& c = *ancf_table_coupling(t, coupling++);
            cable.carryReaction[i] = vectorOf(c.impulse) / ancf_kick(&time);
        } else {
            const int knot = knotOfCarrier[i];
            cable.setCarryReaction(i, knot < 0 ? Vector3r(Vector3r::Zero())
                                               : Vector3r(vectorOf(ancf_table_place(t, knot)->impulse) / time.step));
        }
    }
}

// Ways and speeds for spheres that ask in the next step; if none asked in this one, what rested is forgotten.
void CableContacts::follow(const CableEngine& cable) {
    shown->followed = shown->asked.exchange(false);
    if (shown->followed) {
        ancf_motion_follow(motion.get(), cable.theModel(), cable.scene->dt);
        shown->resting.resize(cable.scene->interactions->size());
    }
    if (!shown->followed || !cable.sleep) ++shown->epoch;
}

void CableContacts::look(CableEngine& cable) {
    follow(cable);
    if (kinds == 0) return;
    const bool hold = ancf_boxes_hold(boxes.get(), cable.theModel()) && cable.scene->dt == plannedStep;
    outgrown = !cable.sleep || !hold;
    if (!outgrown) return;
    plan(cable);
    cable.scene->doSort = true;
}

CableContacts::Energies CableContacts::energies() const {
    Energies e {};
    for (int i = 0; i < ancf_table_contacts(table.get()); ++i) {
        const ancf_contact& c = *ancf_table_contact(table.get(), i);
        e.elastic += c.energy;
        e.damped += c.damped;
        e.rubbed += c.rubbed;
        e.found += c.found;
    }
    for (size_t i = 0; i < entries.size(); ++i) {
        const Real work = ancf_table_body(table.get(), static_cast<int>(i))->work;
        (work > 0 ? e.given : e.taken) += std::abs(work);
    }
    return e;
}

Real CableContacts::found() const {
    Real sum = 0;
    for (int i = 0; i < ancf_table_contacts(table.get()); ++i) sum += ancf_table_contact(table.get(), i)->found;
    return sum;
}

void CableContacts::noteFullest() {
    const ancf_table* t = table.get();
    Real most = 0;
    int number = -1;
    for (int i = 0; i < ancf_table_contacts(t); ++i)
        if (const Real stored = ancf_table_contact(table.get(), i)->energy; stored > most) {
            most = stored;
            number = i;
        }
    fullest = number < 0 ? Pair() : pairOf(number);
}

string CableContacts::mostFound() const {
    Real most = 0;
    int number = -1;
    for (int i = 0; i < ancf_table_contacts(table.get()); ++i)
        if (const Real size = std::abs(ancf_table_contact(table.get(), i)->found); size > most) {
            most = size;
            number = i;
        }
    if (number >= 0) return nameOf(pairOf(number));
    return fullest.first >= 0 ? nameOf(fullest) : string();
}

Vector3r CableContacts::velocityBefore(Body::id_t id, const Vector3r& arm) const {
    const Real* before = ancf_table_body(table.get(), entryOfBody[id])->before;
    return vectorOf(before) + vectorOf(before + 3).cross(arm);
}

void CableContacts::impulseOn(Vector3r& impulse, const ancf_model* m, int dof) const {
    ancf_table_impulse(impulse.data(), table.get(), m, dof);
}

// ---------------------------------------------------------------- saved

void CableContacts::recall(vector<int>& pairs, vector<Real>& values) const {
    for (const ancf_memory& one : memory) {
        pairs.insert(pairs.end(), {one.first, one.second, one.segment});
        values.insert(values.end(), one.friction, one.friction + 3);
        values.insert(values.end(), one.xi, one.xi + 2);
        values.insert(values.end(), one.late, one.late + 3);
        values.push_back(one.owed);
    }
}

void CableContacts::remember(const vector<int>& pairs, const vector<Real>& values) {
    constexpr size_t each = 9;
    memory.clear();
    for (size_t i = 0; each * (i + 1) <= values.size() && 3 * (i + 1) <= pairs.size(); ++i) {
        ancf_memory one {pairs[3 * i], pairs[3 * i + 1], pairs[3 * i + 2], {}, {}, {}, 0};
        const Real* from = &values[each * i];
        std::copy(from, from + 3, one.friction);
        std::copy(from + 3, from + 5, one.xi);
        std::copy(from + 5, from + 8, one.late);
        one.owed = from[8];
        memory.push_back(one);
    }
}

} // namespace yade
