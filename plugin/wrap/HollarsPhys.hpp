// SPDX-License-Identifier: GPL-2.0-or-later
// Contact with Hunt-Crossley normal force and Hollars friction: physics, the functors that make it, and its law.
#pragma once

#include "FrictionRule.hpp"
#include "HollarsMat.hpp"

#include <core/Dispatching.hpp>
#include <pkg/common/NormShearPhys.hpp>
#include <pkg/dem/ScGeom.hpp>

#include <atomic>
#include <mutex>

extern "C" {
#include "ancf/law.h"
}

namespace yade {

class HollarsPhys : public NormShearPhys {
public:
    ancf_normal normalLaw() const;
    ancf_friction frictionLaw() const;
    Real damping(Real depth) const; // of the normal force against the speed of approach [N s/m]

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR(HollarsPhys, NormShearPhys,
        "A contact between two bodies of which at least one is of :yref:`HollarsMat`. kn and ks are tangents [N/m]; "
        "normalForce and shearForce act on the second body [N].",
        ((Real, tangensOfFrictionAngle, std::numeric_limits<Real>::quiet_NaN(), Attr::hidden, "Where FrictPhys has its own: utils.setContactFriction writes here what the materials say as well."))
        ((Real, normalStiffness, 0, , "Stiffness $k$ of $f=k\\delta^n$ [N/m^n] (Shan, Guo and Gill 2019, Eq. 8)."))
        ((Real, normalExponent, 1.5, , "Exponent $n$ [-]."))
        ((Real, impactDamping, 0, , "$\\alpha$ of $c=\\frac32\\alpha k$ [s/m] (Eq. 10)."))
        ((Real, dashpot, 0, , "$c$ of the spring-dashpot [N s/m]."))
        ((Real, staticFriction, 0, , "$\\mu_s$ [-]."))
        ((Real, kineticFriction, 0, , "$\\mu_k$ [-]."))
        ((Real, transitionVelocity, 1e-3, , "$v_{t0}$ [m/s]."))
        ((Real, dampingForce, 0, Attr::hidden, "Damping part of the normal force in the last step [N]."))
        ((int, normalKind, 2, Attr::hidden, "Which normal force the law computes."))
        ((int, frictionKind, 2, Attr::hidden, "Which friction the law computes."))
        ((long, mixedOf, -1, Attr::hidden, "Mark of the materials' values that it was mixed of.")),
        createIndex();
    )
    // clang-format on
    REGISTER_CLASS_INDEX(HollarsPhys, NormShearPhys)

    long edition = 0; // of MaterialWatch, for which it is what its materials say; behind what others write to
};
REGISTER_SERIALIZABLE(HollarsPhys);

inline bool isHollars(const IPhys& phys) { return phys.getClassIndex() == HollarsPhys::getClassIndexStatic(); }

// Radius of a contact [m]: 1 over the sum of mean curvatures, r1 r2/(r1 + r2) for spheres. What is neither sphere nor
// cable nor sheave is flat; infinite if both are.
Real radiusOfContact(const Shape& first, const Shape& second);

// Stiffness and exponent of a contact of that radius [m]: a material's own, the softer one if both give it, else Hertz.
// NaN or infinite where there is none; lawFault() says why.
void setStiffness(HollarsPhys& phys, const ElastMat& a, const ElastMat& b, Real radius);

// Laws of two materials: friction by the rule, the larger transition velocity, the mean of the damping.
void mixHollars(HollarsPhys& phys, const ElastMat& first, const ElastMat& second, Real radius,
                const FrictionRule& rule);

// The rule of the scene's functor for two materials; the smaller one counts where there is none.
FrictionRule frictionRuleOf(const Scene& scene, const Material& first, const Material& second);

// Why a contact cannot be computed, with the values that are at fault; empty where it can. radius: of the contact [m],
// NaN where it is not known.
string lawFault(const HollarsPhys& phys, const Material* first, const Material* second, Real radius);
// Mixed anew if one of the materials was edited since.
void followMaterials(HollarsPhys& phys, const Scene& scene, const Interaction& contact);

class Ip2_HollarsMat_HollarsMat_HollarsPhys : public IPhysFunctor {
public:
    void postLoad(Ip2_HollarsMat_HollarsMat_HollarsPhys&);
    void setFriction(int first, int second, Real staticFriction, Real kineticFriction);
    void go(const shared_ptr<Material>&, const shared_ptr<Material>&, const shared_ptr<Interaction>&) override;
    FUNCTOR2D(HollarsMat, HollarsMat)
    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(Ip2_HollarsMat_HollarsMat_HollarsPhys, IPhysFunctor,
        "Contact of two :yref:`HollarsMat`: Hertz stiffness from both elastic constants and the radii of the shapes, "
        "a plane's being infinite (Eq. 8-9), unless a material gives normalStiffness (the smaller one if both do). "
        "$\\mu_s$ and $\\mu_k$ are by frictionRule the smaller, unless setFriction gives the pair its own; $v_{t0}$ is the larger of the two, $\\alpha$ and the dashpot their mean.",
        ((string, frictionRule, "min", Attr::triggerPostLoad, "How coefficients of friction of two materials make one: 'min', 'max' or 'mean'."))
        ((vector<int>, frictionPairs, , Attr::readonly, "Ids of two materials each whose contacts have coefficients of their own."))
        ((vector<Real>, pairFriction, , Attr::readonly, "$\\mu_s$ and $\\mu_k$ of each of these pairs [-].")),
        ,
        .def("setFriction", &Ip2_HollarsMat_HollarsMat_HollarsPhys::setFriction, (py::arg("first"), py::arg("second"), py::arg("staticFriction"), py::arg("kineticFriction")), "Gives contacts of two materials, by their ids, coefficients of friction of their own. ValueError on bad values.")
    )
    // clang-format on
};
REGISTER_SERIALIZABLE(Ip2_HollarsMat_HollarsMat_HollarsPhys);

// Declared for two ElastMat, from which both materials derive: only a functor for twice the same class takes its
// arguments in any order. One for (FrictMat, HollarsMat) makes InteractionLoop's assert(!swap) end YADE where the
// FrictMat comes second. Whatever is declared for a pair's own classes is nearer to it and goes first.
class Ip2_FrictMat_HollarsMat_HollarsPhys : public IPhysFunctor {
public:
    void postLoad(Ip2_FrictMat_HollarsMat_HollarsPhys&);
    void setFriction(int first, int second, Real staticFriction, Real kineticFriction);
    void go(const shared_ptr<Material>&, const shared_ptr<Material>&, const shared_ptr<Interaction>&) override;
    FUNCTOR2D(ElastMat, ElastMat)
    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(Ip2_FrictMat_HollarsMat_HollarsPhys, IPhysFunctor,
        "Contact of a FrictMat with a :yref:`HollarsMat`, in any order: the former counts as "
        "$\\mu_s=\\mu_k=\\tan\\varphi$ with its elastic constants; $v_{t0}$, $\\alpha$ and the rest come from the latter. "
        "Takes every pair of elastic materials that has no functor of its own in the list: an ElastMat without friction "
        "leaves the coefficients to the other one, and without any HollarsMat nothing is damped and $v_{t0}$ is 1e-3 m/s.",
        ((string, frictionRule, "min", Attr::triggerPostLoad, "How coefficients of friction of two materials make one: 'min', 'max' or 'mean'."))
        ((vector<int>, frictionPairs, , Attr::readonly, "Ids of two materials each whose contacts have coefficients of their own."))
        ((vector<Real>, pairFriction, , Attr::readonly, "$\\mu_s$ and $\\mu_k$ of each of these pairs [-].")),
        ,
        .def("setFriction", &Ip2_FrictMat_HollarsMat_HollarsPhys::setFriction, (py::arg("first"), py::arg("second"), py::arg("staticFriction"), py::arg("kineticFriction")), "Gives contacts of two materials, by their ids, coefficients of friction of their own. ValueError on bad values.")
    )
    // clang-format on
};
REGISTER_SERIALIZABLE(Ip2_FrictMat_HollarsMat_HollarsPhys);

// Energy of one kind that the contacts of a step add to O.energy. They are summed in whole multiples of 2^-88 J and
// shown at once: the same bits in any order. Not for several threads at a time.
class EnergyOfStep {
    const char* name;
    bool fromZero; // in each step
    int number = -1;
    bool begun = false;
    Real before = 0;
    __int128 sum = 0;

public:
    EnergyOfStep(const char* name, bool fromZero) : name(name), fromZero(fromZero) {}
    void beginStep() { begun = false; }
    void add(EnergyTracker& all, Real value);
};

// The step [s] for contacts of HollarsMat between bodies that meet at a speed [m/s], normal forces of a kind: a seventh
// of the shortest contact; infinite if none can touch.
Real contactTimeStep(const Scene& scene, int normalKind, Real speed);

class Law2_ScGeom_HollarsPhys_Hollars : public LawFunctor {
    std::mutex mutex;
    std::atomic<long> begun {-1};        // the iteration for which beginStep ran
    std::atomic<size_t> bodies {0};      // how many there were then
    vector<int> touchedBefore;           // like `touched`, in the step before
    Vector3r gravity = Vector3r::Zero(); // as NewtonIntegrator will apply it
    int normalKind = 2, frictionKind = 2;
    EnergyOfStep elastic {"contactElastic", true}, damped {"contactDamping", false}, rubbed {"contactFriction", false};

    void beginStep();
    Real share(const Body& moved) const;
    void count(const Body& moved);

public:
    bool go(shared_ptr<IGeom>&, shared_ptr<IPhys>&, Interaction*) override;
    void postLoad(Law2_ScGeom_HollarsPhys_Hollars&);
    Real contactTimeStep(Real speed) const;
    FUNCTOR2D(ScGeom, HollarsPhys)
    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(Law2_ScGeom_HollarsPhys_Hollars, LawFunctor,
        "Normal force by Table 1 and friction by Eq. 11 of Shan, Guo and Gill (2019) between bodies that are no cables. "
        "Damping acts at the velocity in the middle of the step, friction at the one after it: solved with the inertia of "
        "both bodies, gravity, and the number of contacts that each had in the step before, which all act at once. "
        "The forces are the same to the last bit for any number of threads and after loading, whatever the "
        "order of contacts.",
        ((string, normal, "nonlinear", Attr::triggerPostLoad, "'nonlinear' (Hunt-Crossley), 'hertz' or 'linear' (spring-dashpot)."))
        ((string, friction, "hollars", Attr::triggerPostLoad, "'hollars', 'coulomb' (regularised below $v_{t0}$) or 'none'."))
        ((vector<int>, touched, , Attr::hidden, "For each body, contacts that carried force in the last step in which there was any."))
        ((long, touchedIter, -2, Attr::hidden, "That step.")),
        ,
        .def("contactTimeStep", &Law2_ScGeom_HollarsPhys_Hollars::contactTimeStep, (py::arg("speed")),
             "The step [s] for contacts of the spheres, boxes, facets, walls and sheaves in the scene that are approached at "
             "a speed [m/s], pairs without a common bit of groupMask left out: a seventh of the shortest contact time. Single impacts come back within 1 % there, and "
             "a body is stable with twelve such contacts. Infinite if none can touch.")
    )
    // clang-format on
};
REGISTER_SERIALIZABLE(Law2_ScGeom_HollarsPhys_Hollars);

} // namespace yade
