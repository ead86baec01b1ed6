// SPDX-License-Identifier: GPL-2.0-or-later
#include "HollarsPhys.hpp"

#include "CableElement.hpp"
#include "Mobility.hpp"
#include "Sheave.hpp"

#include <core/Scene.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace yade {

YADE_PLUGIN((HollarsPhys)(Ip2_HollarsMat_HollarsMat_HollarsPhys)(Ip2_FrictMat_HollarsMat_HollarsPhys))
YADE_PLUGIN((Law2_ScGeom_HollarsPhys_Hollars))

ancf_normal HollarsPhys::normalLaw() const {
    const auto kind = static_cast<ancf_normal_kind>(normalKind);
    return {kind, normalStiffness, normalExponent, kind == ANCF_NORMAL_LINEAR ? dashpot : impactDamping};
}

ancf_friction HollarsPhys::frictionLaw() const {
    return {static_cast<ancf_friction_kind>(frictionKind), staticFriction, kineticFriction, transitionVelocity};
}

Real HollarsPhys::damping(Real depth) const {
    if (normalKind == ANCF_NORMAL_LINEAR) return dashpot;
    return normalKind == ANCF_NORMAL_HERTZ ? 0
                                           : 1.5 * impactDamping * normalStiffness * std::pow(depth, normalExponent);
}

namespace {
    // Radius of the contact [m]: 1 over the sum of mean curvatures, r1 r2/(r1 + r2) for spheres. A sheave has that of
    // its groove's bottom; what is neither is taken as flat.
    Real contactRadius(const Scene* scene, const Interaction& contact) {
        Real curvature = 0;
        for (const auto id : {contact.getId1(), contact.getId2()})
            if (const auto* sphere = dynamic_cast<const Sphere*>((*scene->bodies)[id]->shape.get()))
                curvature += 1 / sphere->radius;
            else if (const auto* cable = CableElement::of(*(*scene->bodies)[id])) curvature += 1 / cable->radius;
            else if (const auto* sheave = dynamic_cast<const Sheave*>((*scene->bodies)[id]->shape.get()))
                curvature += ancf_groove_curvature(&sheave->groove());
        return curvature > 0 ? 1 / curvature : std::numeric_limits<Real>::infinity();
    }
} // namespace

void setStiffness(HollarsPhys& phys, const ElastMat& a, const ElastMat& b, Real radius) {
    phys.normalStiffness = ancf_hertz_stiffness(radius, a.young, a.poisson, b.young, b.poisson);
    phys.normalExponent = 1.5;
    Real given = std::numeric_limits<Real>::infinity();
    for (const auto* each : {&a, &b})
        if (const auto* mat = dynamic_cast<const HollarsMat*>(each); mat && mat->normalStiffness < given) {
            phys.normalStiffness = given = mat->normalStiffness;
            phys.normalExponent = mat->normalExponent;
        }
    if (!std::isfinite(phys.normalStiffness))
        throw std::runtime_error("Ip2_…_HollarsPhys: two bodies that are not spheres touch, so there is no radius "
                                 "for Hertz: give HollarsMat.normalStiffness");
}

void mixHollars(HollarsPhys& phys, const HollarsMat& a, const HollarsMat& b, Real radius) {
    setStiffness(phys, a, b, radius);
    phys.impactDamping = (a.impactDamping + b.impactDamping) / 2;
    phys.dashpot = (a.dashpot + b.dashpot) / 2;
    phys.staticFriction = std::min(a.staticFriction, b.staticFriction);
    phys.kineticFriction = std::min(a.kineticFriction, b.kineticFriction);
    phys.transitionVelocity = std::max(a.transitionVelocity, b.transitionVelocity);
}

void Ip2_HollarsMat_HollarsMat_HollarsPhys::go(const shared_ptr<Material>& first, const shared_ptr<Material>& second,
                                               const shared_ptr<Interaction>& contact) {
    if (contact->phys) return;
    const auto &a = static_cast<const HollarsMat&>(*first), &b = static_cast<const HollarsMat&>(*second);
    auto phys = shared_ptr<HollarsPhys>(new HollarsPhys);
    mixHollars(*phys, a, b, contactRadius(scene, *contact));
    contact->phys = phys;
}

void Ip2_FrictMat_HollarsMat_HollarsPhys::go(const shared_ptr<Material>& first, const shared_ptr<Material>& second,
                                             const shared_ptr<Interaction>& contact) {
    if (contact->phys) return;
    const auto& a = static_cast<const FrictMat&>(*first);
    const auto& b = static_cast<const HollarsMat&>(*second);
    const Real mu = std::tan(a.frictionAngle);
    auto phys = shared_ptr<HollarsPhys>(new HollarsPhys);
    setStiffness(*phys, a, b, contactRadius(scene, *contact));
    phys->impactDamping = b.impactDamping;
    phys->dashpot = b.dashpot;
    phys->staticFriction = std::min(mu, b.staticFriction);
    phys->kineticFriction = std::min(mu, b.kineticFriction);
    phys->transitionVelocity = b.transitionVelocity;
    contact->phys = phys;
}

namespace {
    int choose(const string& name, const std::array<const char*, 3>& names, const char* attribute) {
        for (int i = 0; i < 3; ++i)
            if (name == names[i]) return i;
        throw std::invalid_argument("Law2_ScGeom_HollarsPhys_Hollars." + string(attribute) + " = '" + name +
                                    "': must be '" + names[0] + "', '" + names[1] + "' or '" + names[2] + "'");
    }
} // namespace

void Law2_ScGeom_HollarsPhys_Hollars::postLoad(Law2_ScGeom_HollarsPhys_Hollars&) {
    normalKind = choose(normal, {"linear", "hertz", "nonlinear"}, "normal");
    frictionKind = choose(friction, {"none", "coulomb", "hollars"}, "friction");
}

// Elastic energy of the contact as it stands, and what its damping takes out in this step.
void Law2_ScGeom_HollarsPhys_Hollars::trackNormal(Real elasticForce, Real force, Real rate, Real energy) {
    scene->energy->add(energy, "contactElastic", elasticIx, true);
    scene->energy->add((force - elasticForce) * rate * scene->dt, "contactDamping", dampIx, false);
}

bool Law2_ScGeom_HollarsPhys_Hollars::go(shared_ptr<IGeom>& ig, shared_ptr<IPhys>& ip, Interaction* contact) {
    const auto& geom = static_cast<const ScGeom&>(*ig);
    auto& phys = static_cast<HollarsPhys&>(*ip);
    const Body &b1 = *(*scene->bodies)[contact->getId1()], &b2 = *(*scene->bodies)[contact->getId2()];
    const CableElement *p1 = nullptr, *p2 = nullptr;
    phys.normalKind = normalKind;
    phys.frictionKind = frictionKind;
    const bool excluded = (p1 && p1->excludes(b2.id)) || (p2 && p2->excludes(b1.id));
    if (geom.penetrationDepth < 0 || excluded) {
        phys.kn = phys.ks = 0;
        phys.normalForce = phys.shearForce = Vector3r::Zero();
        phys.dampingForce = 0;
        return excluded; // an excluded pair stays, without force
    }
    // A cable has no twist to take a torque: forces act at its centreline, and velocities are taken there.
    const Vector3r at = p1 ? b1.state->pos : p2 ? b2.state->pos : geom.contactPoint;
    const Vector3r slip = velocityAt(*b1.state, at) - velocityAt(*b2.state, p1 && p2 ? b2.state->pos : at);
    const ancf_normal law = phys.normalLaw();
    // The damping of a cable's contact is solved for by its engine, like friction.
    const Real rate = p1 || p2 ? 0 : slip.dot(geom.normal);
    const Real force = ancf_normal_force(&law, geom.penetrationDepth, rate);
    phys.kn = ancf_normal_tangent(&law, geom.penetrationDepth);
    phys.normalForce = force * geom.normal;
    if (scene->trackEnergy && (p1 || p2)) {
        scene->energy->add(ancf_normal_energy(&law, geom.penetrationDepth), "contactElastic", elasticIx, true);
    } else if (scene->trackEnergy) {
        const ancf_normal elastic = {law.kind, law.stiffness, law.exponent, 0};
        trackNormal(ancf_normal_force(&elastic, geom.penetrationDepth, 0), force, rate,
                    ancf_normal_energy(&law, geom.penetrationDepth));
    }
    const ancf_friction rub = phys.frictionLaw();
    phys.ks = force * ancf_friction_slope(&rub) / scene->dt;
    if (p1 || p2) return true;

    const Vector3r tangential = slip - rate * geom.normal;
    const Real speed = tangential.norm();
    phys.shearForce = Vector3r::Zero();
    if (speed > 0 && force > 0) {
        const Vector3r direction = tangential / speed;
        // All contacts of a body act at once: each is solved with its share of the mass.
        const Real w = sharedCompliance(*scene, b1, at, direction) + sharedCompliance(*scene, b2, at, direction);
        const Real left = ancf_friction_solve(&rub, speed, w * scene->dt * force);
        phys.shearForce = ancf_friction_coefficient(&rub, left) * force * direction;
        if (scene->trackEnergy)
            scene->energy->add(phys.shearForce.norm() * left * scene->dt, "contactFriction", frictionIx, false);
    }
    const Vector3r total = phys.normalForce + phys.shearForce;
    for (const auto& [body, sign] : {std::pair(&b1, -1.), std::pair(&b2, 1.)}) {
        scene->forces.addForce(body->id, sign * total);
        scene->forces.addTorque(body->id, (at - body->state->pos).cross(sign * total));
    }
    return true;
}

} // namespace yade
