// SPDX-License-Identifier: GPL-2.0-or-later
#include "HollarsPhys.hpp"

#include "Attributes.hpp"
#include "CableElement.hpp"
#include "Drive.hpp"
#include "LateError.hpp"
#include "MaterialWatch.hpp"
#include "Mobility.hpp"
#include "Sheave.hpp"
#include "text.hpp"

#include <core/InteractionLoop.hpp>
#include <core/Omega.hpp>
#include <core/Scene.hpp>
#include <pkg/common/Box.hpp>
#include <pkg/common/Collider.hpp>
#include <pkg/common/Facet.hpp>
#include <pkg/common/Wall.hpp>
#include <pkg/dem/NewtonIntegrator.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

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
    if (normalKind == ANCF_NORMAL_HERTZ) return 0;
    const ancf_normal spring = {ANCF_NORMAL_HERTZ, normalStiffness, normalExponent, 0};
    return 1.5 * impactDamping * ancf_normal_force(&spring, depth, 0);
}

namespace {
    constexpr Real infinite = std::numeric_limits<Real>::infinity();

    // Curvature of a sheave where a ball of that radius touches it [1/m]. One that does not fit into the round bottom
    // touches walls or lips: those are straight across, or edges, for which Hertz has no radius, so that only the bend
    // around the axis is left.
    Real sheaveCurvature(const ancf_groove& groove, Real ball) {
        return ball < groove.fillet ? ancf_groove_curvature(&groove) : .5 / groove.radius;
    }

    // Where both are flat, the radii count that their Ig2 functor gave the contact.
    Real contactRadius(const Scene* scene, const Interaction& contact) {
        const Real radius =
            radiusOfContact(*(*scene->bodies)[contact.getId1()]->shape, *(*scene->bodies)[contact.getId2()]->shape);
        const auto* given = dynamic_cast<const GenericSpheresContact*>(contact.geom.get());
        if (std::isfinite(radius) || !given) return radius;
        Real curvature = 0;
        for (const Real each : {given->refR1, given->refR2})
            if (each > 0) curvature += 1 / each;
        return curvature > 0 ? 1 / curvature : infinite;
    }
} // namespace

Real radiusOfContact(const Shape& first, const Shape& second) {
    Real curvature = 0, ball = 0;
    for (const Shape* shape : {&first, &second})
        if (const auto* sphere = dynamic_cast<const Sphere*>(shape)) {
            ball = sphere->radius;
            curvature += 1 / ball;
        } else if (const auto* cable = dynamic_cast<const CableElement*>(shape)) {
            ball = cable->radius; // the study's spheres of the cable's thickness
            curvature += 1 / ball;
        }
    for (const Shape* shape : {&first, &second})
        if (const auto* sheave = dynamic_cast<const Sheave*>(shape))
            curvature += sheaveCurvature(sheave->groove(), ball);
    return curvature > 0 ? 1 / curvature : infinite;
}

void setStiffness(HollarsPhys& phys, const ElastMat& a, const ElastMat& b, Real radius) {
    phys.normalStiffness = ancf_hertz_stiffness(radius, a.young, a.poisson, b.young, b.poisson);
    phys.normalExponent = 1.5;
    Real given = infinite;
    for (const auto* each : {&a, &b})
        if (const auto* mat = dynamic_cast<const HollarsMat*>(each); mat && mat->normalStiffness < given) {
            phys.normalStiffness = given = mat->normalStiffness;
            phys.normalExponent = mat->normalExponent;
        }
}

namespace {
    string elasticText(const Material* material) {
        const auto* elastic = dynamic_cast<const ElastMat*>(material);
        if (!elastic) return "";
        return text(" (", elastic->getClassName(), " '", elastic->label, "': young = ", elastic->young,
                    ", poisson = ", elastic->poisson, ")");
    }
} // namespace

string lawFault(const HollarsPhys& phys, const Material* first, const Material* second, Real radius) {
    const ancf_normal law = phys.normalLaw();
    const ancf_friction rub = phys.frictionLaw();
    if (std::isinf(radius) && std::isinf(phys.normalStiffness))
        return "two bodies that are not spheres touch, so there is no radius for Hertz: give "
               "HollarsMat.normalStiffness";
    if (ancf_normal_check(&law) || !finite(law.stiffness) || !finite(law.exponent) || !finite(law.damping))
        return text("normalStiffness = ", law.stiffness, ", normalExponent = ", law.exponent,
                    ", impactDamping = ", phys.impactDamping, ", dashpot = ", phys.dashpot,
                    ": must be below 1e100, the first two above 0, the others not below 0", elasticText(first),
                    elasticText(second));
    if (ancf_friction_check(&rub) || !finite(rub.mu_s) || !finite(rub.mu_k) || !finite(rub.v0))
        return text("staticFriction = ", rub.mu_s, ", kineticFriction = ", rub.mu_k, ", transitionVelocity = ", rub.v0,
                    ": must be below 1e100, the coefficients not below 0, the velocity above 0");
    return "";
}

namespace {
    template <class F> FrictionRule ruleOf(const F& functor) {
        return checkedRule(functor.getClassName(), functor.frictionRule, functor.frictionPairs, functor.pairFriction);
    }
} // namespace

namespace {
    // What a material says of friction and damping. Where it says nothing: infinite friction, no velocity, NaN.
    struct Rub {
        Real staticFriction = infinite, kineticFriction = infinite, transitionVelocity = 0;
        Real impactDamping = std::numeric_limits<Real>::quiet_NaN(), dashpot = impactDamping;

        explicit Rub(const ElastMat& material) {
            if (const auto* hollars = dynamic_cast<const HollarsMat*>(&material)) {
                staticFriction = hollars->staticFriction;
                kineticFriction = hollars->kineticFriction;
                transitionVelocity = hollars->transitionVelocity;
                impactDamping = hollars->impactDamping;
                dashpot = hollars->dashpot;
            } else if (const auto* frict = dynamic_cast<const FrictMat*>(&material)) {
                staticFriction = kineticFriction = std::tan(frict->frictionAngle);
            }
        }
    };

    Real meanOfGiven(Real a, Real b) {
        if (std::isnan(a)) return std::isnan(b) ? 0 : b;
        return std::isnan(b) ? a : (a + b) / 2;
    }

    void makePhys(const Scene* scene, const shared_ptr<Material>& first, const shared_ptr<Material>& second,
                  Interaction& contact, const FrictionRule& rule) {
        if (contact.phys) return;
        auto phys = shared_ptr<HollarsPhys>(new HollarsPhys);
        for (const auto& material : {first, second}) MaterialWatch::instance().add(material);
        const Real radius = contactRadius(scene, contact);
        mixHollars(*phys, static_cast<const ElastMat&>(*first), static_cast<const ElastMat&>(*second), radius, rule);
        if (const string fault = lawFault(*phys, first.get(), second.get(), radius); !fault.empty())
            throwLater(*scene,
                       text("the contact of bodies ", contact.getId1(), " and ", contact.getId2(), ": ", fault));
        phys->mixedOf = rule.mark(MaterialWatch::mark(*first, *second), *first, *second);
        phys->edition = MaterialWatch::instance().edition();
        contact.phys = phys;
    }
} // namespace

void followMaterials(HollarsPhys& phys, const Scene& scene, const Interaction& contact) {
    MaterialWatch& watch = MaterialWatch::instance();
    if (phys.edition == watch.edition()) return;
    const shared_ptr<Material>&first = (*scene.bodies)[contact.getId1()]->material,
          &second = (*scene.bodies)[contact.getId2()]->material;
    const auto *a = dynamic_cast<const ElastMat*>(first.get()), *b = dynamic_cast<const ElastMat*>(second.get());
    if (!a || !b) return;
    if (phys.edition == 0) // just loaded
        for (const auto& material : {first, second}) watch.add(material);
    phys.edition = watch.edition();
    const FrictionRule rule = frictionRuleOf(scene, *a, *b);
    const long mark = rule.mark(MaterialWatch::mark(*a, *b), *a, *b);
    if (mark == phys.mixedOf) return;
    if (phys.mixedOf >= 0) mixHollars(phys, *a, *b, contactRadius(&scene, contact), rule);
    phys.mixedOf = mark;
}

FrictionRule frictionRuleOf(const Scene& scene, const Material& first, const Material& second) {
    const bool hollars = dynamic_cast<const HollarsMat*>(&first) && dynamic_cast<const HollarsMat*>(&second);
    FrictionRule rule;
    bool nearest = false;
    for (const InteractionLoop* loop : knownEngines(scene).loops) {
        if (!loop->physDispatcher) continue;
        for (const auto& functor : loop->physDispatcher->functors) {
            const auto* own = dynamic_cast<const Ip2_HollarsMat_HollarsMat_HollarsPhys*>(functor.get());
            const auto* any = dynamic_cast<const Ip2_FrictMat_HollarsMat_HollarsPhys*>(functor.get());
            if (own && hollars) {
                rule = ruleOf(*own);
                nearest = true;
            } else if (any && !nearest) {
                rule = ruleOf(*any);
            }
        }
    }
    return rule;
}

void mixHollars(HollarsPhys& phys, const ElastMat& first, const ElastMat& second, Real radius,
                const FrictionRule& rule) {
    setStiffness(phys, first, second, radius);
    const Rub a(first), b(second);
    phys.transitionVelocity = HollarsPhys().transitionVelocity;
    const Real* own = rule.own(first, second);
    phys.staticFriction = own ? own[0] : rule.mix(a.staticFriction, b.staticFriction);
    phys.kineticFriction = own ? own[1] : rule.mix(a.kineticFriction, b.kineticFriction);
    if (const Real v = std::max(a.transitionVelocity, b.transitionVelocity); v > 0) phys.transitionVelocity = v;
    phys.impactDamping = meanOfGiven(a.impactDamping, b.impactDamping);
    phys.dashpot = meanOfGiven(a.dashpot, b.dashpot);
}

void Ip2_HollarsMat_HollarsMat_HollarsPhys::go(const shared_ptr<Material>& first, const shared_ptr<Material>& second,
                                               const shared_ptr<Interaction>& contact) {
    makePhys(scene, first, second, *contact, ruleOf(*this));
}

void Ip2_HollarsMat_HollarsMat_HollarsPhys::postLoad(Ip2_HollarsMat_HollarsMat_HollarsPhys&) {
    ruleOf(*this);
    MaterialWatch::instance().lookAgain();
}

void Ip2_HollarsMat_HollarsMat_HollarsPhys::setFriction(int first, int second, Real mu_s, Real mu_k) {
    setPairFriction(frictionPairs, pairFriction, getClassName(), first, second, mu_s, mu_k);
    MaterialWatch::instance().lookAgain();
}

void Ip2_FrictMat_HollarsMat_HollarsPhys::go(const shared_ptr<Material>& first, const shared_ptr<Material>& second,
                                             const shared_ptr<Interaction>& contact) {
    makePhys(scene, first, second, *contact, ruleOf(*this));
}

void Ip2_FrictMat_HollarsMat_HollarsPhys::postLoad(Ip2_FrictMat_HollarsMat_HollarsPhys&) {
    ruleOf(*this);
    MaterialWatch::instance().lookAgain();
}

void Ip2_FrictMat_HollarsMat_HollarsPhys::setFriction(int first, int second, Real mu_s, Real mu_k) {
    setPairFriction(frictionPairs, pairFriction, getClassName(), first, second, mu_s, mu_k);
    MaterialWatch::instance().lookAgain();
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

void EnergyOfStep::add(EnergyTracker& all, Real value) {
    constexpr int quantum = -88, most = 38; // the sum of a step overflows beyond 2^39 J
    if (!begun) {
        begun = true;
        number = -1;
        all.findId(name, number, fromZero);
        before = all.energies.get(static_cast<size_t>(number));
        sum = 0;
    }
    if (std::abs(value) < std::ldexp(1., most)) sum += static_cast<__int128>(std::ldexp(value, -quantum));
    else before += value; // or it is not finite
    all.set(before + std::ldexp(static_cast<Real>(sum), quantum), name, number);
}

// The first contact of a step, in whatever thread, gets here before any goes on.
void Law2_ScGeom_HollarsPhys_Hollars::beginStep() {
    const long iter = scene->iter;
    const size_t now = scene->bodies->size();
    if (begun.load() == iter && bodies.load() == now) return;
    const std::lock_guard<std::mutex> lock(mutex);
    if (begun.load() == iter && bodies.load() == now) return;
    touchedBefore.swap(touched);
    if (touchedIter != iter - 1) touchedBefore.clear();
    touchedBefore.resize(now, 0);
    touched.assign(now, 0);
    touchedIter = iter;
    for (EnergyOfStep* each : {&elastic, &damped, &rubbed}) each->beginStep();
    MaterialWatch::instance().look();
    const NewtonIntegrator* newton = newtonOf(*scene);
    gravity = newton ? newton->gravity : Vector3r(Vector3r::Zero());
    bodies = now;
    begun = iter;
}

// Contacts of a body in the step before, all of which act at once. In this step they are still being found.
Real Law2_ScGeom_HollarsPhys_Hollars::share(const Body& moved) const { return std::max(1, touchedBefore[moved.id]); }

void Law2_ScGeom_HollarsPhys_Hollars::count(const Body& moved) {
#pragma omp atomic
    ++touched[moved.id];
}

namespace {
    // A body in contact, and what answers for it.
    struct Side {
        const Body &body, &moved;
        const Mobility answer;

        Side(const Scene& scene, Body::id_t id)
            : body(*(*scene.bodies)[id]), moved(movedBody(scene, body)), answer(mobility(scene, moved)) {}
        Real compliance(const Vector3r& at, const Vector3r& direction) const {
            return yade::compliance(answer, moved, at, direction);
        }
        // What NewtonIntegrator will add to its velocity of a field of acceleration.
        Vector3r falling(const Vector3r& gravity) const {
            return (answer.inverseMass.array() > 0).select(gravity, Vector3r::Zero());
        }
    };
} // namespace

bool Law2_ScGeom_HollarsPhys_Hollars::go(shared_ptr<IGeom>& ig, shared_ptr<IPhys>& ip, Interaction* contact) {
    const auto& geom = static_cast<const ScGeom&>(*ig);
    const auto refuse = [&](const string& fault) {
        throwLater(*scene, text("the contact of bodies ", contact->getId1(), " and ", contact->getId2(), ": ", fault));
        return true;
    };
    if (!isHollars(*ip)) return refuse(text("phys is a ", ip->getClassName(), ": must be the HollarsPhys that it was"));
    auto& phys = static_cast<HollarsPhys&>(*ip);
    phys.normalKind = normalKind;
    phys.frictionKind = frictionKind;
    const Real depth = geom.penetrationDepth, dt = scene->dt;
    if (depth < 0) return false;
    beginStep();
    followMaterials(phys, *scene, *contact);
    const Side one(*scene, contact->getId1()), two(*scene, contact->getId2());
    const Vector3r at = geom.contactPoint, normal = geom.normal;
    const Vector3r slip = velocityAt(*one.body.state, at) - velocityAt(*two.body.state, at);

    // f = f_elastic + c (rate + new rate)/2. The elastic part depends on places alone: anything else lets a heap of
    // grains gain energy.
    const ancf_normal law = phys.normalLaw(), spring = {law.kind, law.stiffness, law.exponent, 0};
    const Real rate = slip.dot(normal), spell = dt / 2 * (one.compliance(at, normal) + two.compliance(at, normal));
    const Real elasticForce = ancf_normal_force(&spring, depth, 0), c = depth > 0 ? phys.damping(depth) : 0;
    const Real force = std::max(0., (elasticForce + c * rate) / (1 + c * spell));
    phys.kn = ancf_normal_tangent(&law, depth);
    phys.normalForce = force * normal;
    const ancf_friction rub = phys.frictionLaw();
    phys.ks = force * ancf_friction_slope(&rub) / dt;

    Vector3r friction = Vector3r::Zero();
    if (force > 0) {
        for (const Side* side : {&one, &two})
            if (side->answer.movable()) count(side->moved);
        const Vector3r pull = one.falling(gravity) - two.falling(gravity);
        const Vector3r free = slip - rate * normal + dt * (pull - pull.dot(normal) * normal);
        if (const Real speed = free.norm(); speed > 0) {
            const Vector3r direction = free / speed;
            const Real w =
                share(one.moved) * one.compliance(at, direction) + share(two.moved) * two.compliance(at, direction);
            const Real left = ancf_friction_solve(&rub, speed, w * dt * force, 0.0);
            friction = ancf_friction_coefficient(&rub, left) * force * direction;
        }
    }
    if (ancf_normal_check(&law) || ancf_friction_check(&rub) || !std::isfinite(force + c + friction.sum())) {
        const string fault = lawFault(phys, nullptr, nullptr, std::numeric_limits<Real>::quiet_NaN());
        return refuse(fault.empty() ? text("depth = ", depth, " m, speed = ", rate, " m/s: a force of ", elasticForce,
                                           " N: a body's place or velocity is not finite")
                                    : fault);
    }
    const Real damping = force - elasticForce;
    if (scene->trackEnergy) { // half of a step's work is done at the velocity before, half at that after it
        const std::lock_guard<std::mutex> lock(mutex);
        elastic.add(*scene->energy, ancf_normal_energy(&law, depth));
        damped.add(*scene->energy, (phys.dampingForce + damping) * rate * dt / 2);
        rubbed.add(*scene->energy, (phys.shearForce + friction).dot(slip) * dt / 2);
    }
    phys.dampingForce = damping;
    phys.shearForce = friction;
    const Vector3r total = phys.normalForce + phys.shearForce;
    for (const auto& [side, sign] : {std::pair(&one, -1.), std::pair(&two, 1.)})
        addExactly(*scene, side->body, side->moved, sign * total,
                   (at - side->body.state->pos).cross(Vector3r(sign * total)));
    return true;
}

namespace {
    // Bodies that are alike to a contact are represented by those that can need the smallest step.
    struct Kind {
        const ElastMat* material;
        Real curvature; // of the surface, 0: flat, below: a sheave's bottom [1/m]
        Real answer;    // velocity along the normal by a unit impulse, at most; 0: does not move [1/kg]
        const Body* moved;
        bool several; // there are others that move apart from it
        mask_t mask;
    };

    // Along a normal that goes through a place, whatever its direction: the largest eigenvalue.
    Real mostThrough(const Mobility& m, const Vector3r& arm) {
        Matrix3r across;
        across << 0, -arm[2], arm[1], arm[2], 0, -arm[0], -arm[1], arm[0], 0;
        const Matrix3r all = m.massPart() + across.transpose() * m.inverseInertia * across;
        return Eigen::SelfAdjointEigenSolver<Matrix3r>(all, Eigen::EigenvaluesOnly).eigenvalues()[2];
    }

    // Of a box: at the corners, along its axes.
    Real mostAtCorners(const Mobility& m, const Body& moved, const State& state, const Vector3r& half) {
        Real most = 0;
        for (int corner = 0; corner < 4; ++corner)
            for (int axis = 0; axis < 3; ++axis) {
                const Vector3r place(half[0], corner & 1 ? -half[1] : half[1], corner & 2 ? -half[2] : half[2]);
                const Vector3r normal = state.ori * Vector3r(Vector3r::Unit(axis));
                most = std::max(most, compliance(m, moved, state.pos + state.ori * place, normal));
            }
        return most;
    }

    // False for what our law does not handle.
    bool kindOf(Kind& kind, const Scene& scene, const Body& body) {
        const Shape* shape = body.shape.get();
        kind.material = dynamic_cast<const ElastMat*>(body.material.get());
        if (!kind.material || !shape) return false;
        kind.moved = &movedBody(scene, body);
        kind.several = false;
        kind.mask = body.groupMask;
        const Mobility m = mobility(scene, *kind.moved);
        kind.curvature = 0;
        if (const auto* box = dynamic_cast<const Box*>(shape)) {
            kind.answer = mostAtCorners(m, *kind.moved, *body.state, box->extents);
            return true;
        }
        kind.answer = mostThrough(m, body.state->pos - kind.moved->state->pos);
        if (const auto* sphere = dynamic_cast<const Sphere*>(shape)) kind.curvature = 1 / sphere->radius;
        else if (const auto* sheave = dynamic_cast<const Sheave*>(shape))
            kind.curvature = ancf_groove_curvature(&sheave->groove());
        else return dynamic_cast<const Facet*>(shape) || dynamic_cast<const Wall*>(shape);
        return true;
    }

    // For each material and mask, round or not, fixed or not: the body that answers most, and the flattest.
    vector<Kind> kindsOf(const Scene& scene) {
        using Key = std::tuple<Real, Real, Real, Real, bool, bool, bool, mask_t>;
        std::map<Key, std::pair<Kind, Kind>> found;
        // stiffness goes with the root of the radius
        const auto need = [](const Kind& k) { return k.answer / std::sqrt(std::max(k.curvature, 1e-12)); };
        for (const auto& body : *scene.bodies) {
            Kind kind;
            if (!body || !kindOf(kind, scene, *body)) continue;
            const auto* hollars = dynamic_cast<const HollarsMat*>(kind.material);
            const bool given = hollars && std::isfinite(hollars->normalStiffness);
            const Key key {kind.material->young,
                           kind.material->poisson,
                           given ? hollars->normalStiffness : -1,
                           given ? hollars->normalExponent : -1,
                           hollars != nullptr,
                           kind.curvature > 0,
                           kind.answer > 0,
                           kind.mask};
            auto& [first, flattest] = found.insert({key, {kind, kind}}).first->second;
            const bool several = first.several || kind.moved != first.moved;
            if (need(kind) > need(first)) first = kind;
            if (kind.curvature < flattest.curvature) flattest = kind;
            first.several = several;
        }
        vector<Kind> kinds;
        for (const auto& [key, both] : found) {
            kinds.push_back(both.first);
            if (both.second.curvature < both.first.curvature) kinds.push_back(both.second);
        }
        return kinds;
    }

    // Bits of groupMask by which the colliders leave out pairs that both have one of them.
    mask_t apart(const Scene& scene) {
        mask_t bits = 0;
        for (const auto& engine : scene.engines)
            if (const auto* collider = dynamic_cast<const Collider*>(engine.get()))
                bits |= collider->avoidSelfInteractionMask;
        return bits;
    }

    // From touch to parting without damping, of k delta^n at a speed and an answer [s].
    Real contactTime(Real k, Real n, Real speed, Real answer) {
        const Real depth = std::pow((n + 1) * speed * speed / (2 * k * answer), 1 / (n + 1));
        return 2 * depth / speed * std::sqrt(M_PI) * std::tgamma(1 + 1 / (n + 1)) / std::tgamma(.5 + 1 / (n + 1));
    }
} // namespace

Real contactTimeStep(const Scene& s, int normalKind, Real speed) {
    constexpr Real part = 1. / 7;
    const vector<Kind> kinds = kindsOf(s);
    const mask_t avoided = apart(s);
    Real least = infinite;
    for (size_t i = 0; i < kinds.size(); ++i)
        for (size_t j = i; j < kinds.size(); ++j) {
            const Kind &a = kinds[i], &b = kinds[j];
            if (!(a.mask & b.mask) || (a.mask & avoided && b.mask & avoided)) continue;
            const Real answer = a.answer + b.answer, rounder = std::max(a.curvature, b.curvature);
            // half that of the ball: in the tightest groove that it fits into
            const Real curvature = std::max(a.curvature + b.curvature, rounder / 2);
            const bool hollars =
                dynamic_cast<const HollarsMat*>(a.material) || dynamic_cast<const HollarsMat*>(b.material);
            if (!hollars || !(curvature > 0 && answer > 0) || (i == j && !a.several)) continue;
            HollarsPhys phys;
            mixHollars(phys, *a.material, *b.material, 1 / curvature, FrictionRule()); // the step asks for no friction
            phys.normalKind = normalKind;
            if (const string fault = lawFault(phys, a.material, b.material, 1 / curvature); !fault.empty())
                throw std::invalid_argument("contactTimeStep: " + fault);
            const Real n = normalKind == ANCF_NORMAL_LINEAR ? 1 : phys.normalExponent;
            if (!(phys.normalStiffness > 0)) continue;
            // damping makes the approach as short as a spring so much stiffer would
            const Real stiffer = normalKind == ANCF_NORMAL_NONLINEAR ? 1 + 1.5 * phys.impactDamping * speed : 1;
            least = std::min(least, contactTime(stiffer * phys.normalStiffness, n, speed, answer));
        }
    return part * least;
}

Real Law2_ScGeom_HollarsPhys_Hollars::contactTimeStep(Real speed) const {
    if (!(speed > 0 && std::isfinite(speed)))
        throw std::invalid_argument("Law2_ScGeom_HollarsPhys_Hollars.contactTimeStep: speed = " +
                                    std::to_string(speed) + ": must be finite and above 0 [m/s]");
    return yade::contactTimeStep(*Omega::instance().getScene(), normalKind, speed);
}

} // namespace yade
