// SPDX-License-Identifier: GPL-2.0-or-later
// The cables and nets of a scene: holds their state, moves them and what they carry.
#pragma once

#include "CableContacts.hpp"
#include "Drive.hpp"
#include "Guard.hpp"
#include "StepClock.hpp"

#include <core/GlobalEngine.hpp>
#include <core/Scene.hpp>

#include <boost/weak_ptr.hpp>

#include <limits>
#include <memory>

extern "C" {
#include "ancf/implicit.h"
#include "ancf/model.h"
#include "ancf/spool.h"
#include "ancf/step.h"
}

namespace yade {

class CableEngine : public GlobalEngine {
    static constexpr Real strainReserve = .1; // strain up to which automatic steps are stable at least
    static constexpr Real infinity = std::numeric_limits<Real>::infinity();

    friend class CableCheck;
    friend class CableContacts;
    friend class CableRest;
    struct ModelDeleter {
        void operator()(ancf_model* m) const { ancf_model_destroy(m); }
    };

    struct ImplicitDeleter {
        void operator()(ancf_implicit* s) const { ancf_implicit_destroy(s); }
    };

    std::unique_ptr<ancf_model, ModelDeleter> model;
    std::unique_ptr<ancf_implicit, ImplicitDeleter> implicit; // where that is the integrator
    CableContacts touching;
    mutable vector<int> standsFor; // (nodes) one nearer to that which stands for it, itself if it is that; see tied()
    vector<int> carrierOfBody;     // (bodies) number in carryNodes of a body that is centred on its knot, or -1
    struct Held {                  // a body that a node carries or follows, as it was when it was looked at last
        boost::weak_ptr<Body> body;
        const Body* at;
        const State* state;
        Real mass;
        Vector3r inertia;
        unsigned blocked;
        Body::id_t clump;
    };
    vector<Held> carried, followed; // (carryNodes, followNodes)
    struct Shown {                  // of an element: its body and that one's shape
        const Body* body;
        const Shape* shape;
    };
    mutable vector<Shown> elementBodies; // (elementIds) as they were when they were looked at last
    mutable size_t nextBody = 0;         // element whose body is looked at next
    uint64_t checkedSurroundings = 0;    // see SceneCheck::print; 0: not yet checked
    vector<Body::id_t> driven;           // by the scene's drives when these were checked
    int sinceChecked = 0;                // steps, for what is looked at from time to time
    boost::weak_ptr<Scene> home;         // the scene it was last made ready in
    vector<Vector3r> carriedForce;       // (carryNodes) on the body, without the cable [N]
    mutable bool sound = true;           // false: attributes came from outside that checkAttributes() has not let pass
    vector<ancf_spool> spools;           // of the winches, for the model
    Schedules winchSpeeds;
    bool anyCoupled = false;
    bool forgotten = false; // its scene is gone
    bool loaded = false;    // forces may stand in model->external
    bool stepped = false;   // the model has forces and accelerations of a step
    Real movedBy = 0;       // time that the state has gone on since it had these [s]
    StepClock clock;
    int normalKind = 2, frictionKind = 2;
    Real substepLimit = 0;                                        // length of automatic sub-steps at most [s]
    Real kineticAt = 0, elasticAt = 0, heightAt = 0, woundAt = 0; // at the positions that a step starts from [J]
    Real meanKineticAt = 0; // of elements alone, at the mean of the velocities before and after [J]
    enum { LED = -1, PULLED = -2 };
    struct Worked {       // what something does work on in a step, a node or a slope
        int dof, by;      // number in carryNodes if that is a force on the body there, or LED, or PULLED
        Vector3r before;  // its velocity [m/s, 1/s]
        Vector3r pulling; // if PULLED [N]
    };
    vector<Worked> worked;
    struct Led {       // a slope that follows a body
        int dof, twin; // its copies in a block of the state, or -1
        size_t end;    // number in followEnds
        Body::id_t id; // that its node follows
    };
    vector<Led> led;
    struct Fastened {    // a node on a body off its centre
        size_t carried;  // number in carryNodes
        Vector3r before; // its velocity [m/s]
    };
    vector<Fastened> fastened;
    struct Pulls { // what another engine exerts on nodes in one step
        const Engine* by;
        long iter;
        vector<std::pair<int, Vector3r>> forces; // [N]
    };
    vector<Pulls> pulls;
    int pullKick = 1; // how many times their force those on free nodes have in this sub-step
    bool balanced = false, balanceGoesOn = false; // sums are those of this model; and what they began with
    bool pairsChecked = false, partnersChecked = false;
    struct Looked {
        Body::id_t id;
        Real thickness; // what it moves in a step at most without passing by [m], infinity if it can meet no cable
    };
    vector<Looked> lookedAt;
    bool fast = false;       // one of them may pass through a cable in a step
    Real shortest = 0;       // length of an element [m]
    Real watchedStep = 0;    // O.dt that was looked at [s]
    long watchedBodies = -1; // so many bodies were looked at
    struct Kept;
    std::shared_ptr<Kept> kept;                             // between begin() and commit() or rollback()
    vector<std::pair<Body::id_t, unsigned>> freedomsBefore; // of bodies carried since begin()
    int lostIx = -1, elasticIx = -1, kineticIx = -1, gravityIx = -1, dampingIx = -1, frictionIx = -1, contactIx = -1,
        pressIx = -1, halfStepIx = -1, winchIx = -1;

    struct Listed { // in the list of all engines
        explicit Listed(CableEngine* engine);
        ~Listed();
        Listed(const Listed&) = delete;
        Listed& operator=(const Listed&) = delete;
        CableEngine* engine;
    } listed {this};

    void atHome();
    void forget();
    Scene& theScene() const;
    ancf_model* theModel() const { return model.get(); }
    [[noreturn]] void refuse(const string& text) const;
    const Body& elementBody(int element) const;
    int carrierOf(Body::id_t id) const { return carrierOfBody[id]; }
    void setCarryReaction(size_t i, const Vector3r& touched);
    void checkAttributes() const;
    void needSound() const; // nothing if they passed
    static void checkDef(const char* what, const ancf_def& def, const Real* x, const Real* v);
    const Body& heldBody(const char* what, Body::id_t id) const; // a body that a node may have
    const Body& followedBody(Body::id_t id) const;
    const Body& carriedBody(Body::id_t id) const;
    void checkHeldBodies() const;
    void checkElementBody(int element) const;
    void checkCriticalStep(Real step, int element) const;
    void setField(vector<Real>& field, const char* name, const vector<Real>& value);
    void checkNode(int node, const char* what) const;
    void checkRange(const char* what, int first, int n, int all) const;
    const char* claimOf(int node) const; // what holds or carries it, or NULL
    void checkUnclaimed(int node) const;
    void checkSlope(const char* what, int element, int end) const;
    void changed();
    void dropModel();
    void moveLines();
    vector<ancf_slide> slides() const;
    void moveState(vector<Real>&& x, vector<Real>&& v);
    void makeReady();
    auto parts();
    void checkHome() const;
    bool followMaterials();
    void makeModel();
    void makeImplicit();
    void mapBodies();
    void checkScene() const;
    void checkNumbers() const;
    void checkDriven();
    void checkSurroundings() const;
    void checkStart();
    void checkBodies(size_t most = std::numeric_limits<size_t>::max()) const;
    void lookAtBodies() const;
    bool heldBodiesChanged();
    bool lookAtHeldBodies();
    void checkCarried(size_t i) const;
    void checkPartners();
    void startWatch();
    void watch();
    void setLimit();
    Real strainGrowth(Real fastest) const;
    void checkStep(int strained);
    void checkBodyContacts(Real fastest) const;
    void listBodies();
    Real checkFinite();
    [[noreturn]] void tellNode() const;
    void tellBody(const Body& body) const;
    int stepsInside() const;
    void getReady();

    void takeGravity();
    void loadNodesAlone();
    void findForces();
    void holdNodes();
    void listLed();
    Body::id_t followedAt(int node) const;
    void gatherForces();
    bool gatherPulls();
    void kickPulls(int k, int inside);
    Vector3r pullOn(int node, const Vector3r& force) const;
    void gatherOnElements();
    void scatter();
    void startAfresh();
    void startAppended();
    void stepExplicit(int inside);
    void stepImplicit();
    void measureEnergy(const ancf_time& time);
    void noteEnergy();
    void notePressed();
    void trackEnergy();
    Real markOfState() const;
    void keepBalance();
    bool balanceDue();
    bool lossesKnown() const;
    void lookAtBalance(const ancf_time& time);
    void judgeBalance(Real found);
    void noteFastened();
    void bookFastened(const ancf_time& time);
    void noteWorked();
    Vector3r forceOf(const Worked& one) const;
    void bookWorked(const ancf_time& time);
    void checkFound();
    void bookContacts();
    void bookLoad(int node, const Vector3r& change);
    void bookDamping();

    void checkWinches() const;
    void checkWinch(int winch) const;
    void makeSpools();
    void keepSpools();
    void askWinches();
    void feedWinches(const ancf_time& time);
    void endWinches();
    void finishWinches();
    void rebuildKnotted();
    bool knotWinch(int winch);
    void checkClaimed(int winch, int node) const;
    bool bentAroundSomething(int winch, int node) const;
    Real winchWork() const;
    Real winchRate() const;
    Real stableStep(Real strain, int* element) const;

public:
    static constexpr int segmentsMost = 64;   // of an element
    static constexpr int substepsMost = 1000; // in an O.dt

    // The engine of that family in O.engines, or null.
    static CableEngine* of(const Scene& scene, int family);
    // What the elements' bodies of an engine of that family read; null if there is none or it cannot be built.
    static shared_ptr<const CableView> viewOf(const Scene& scene, int family);

    ~CableEngine() override { dropModel(); }
    void action() override;

    // For engines that pull on nodes: where one is, the speed that an impulse of 1 N s gives it [m/s], and forces for
    // the step of an iteration, which take the place of what the same engine gave before.
    Vector3r placeOfNode(int node) const;
    Real mobilityOfNode(int node);
    void pull(const Engine* by, long iter, vector<std::pair<int, Vector3r>>&& forces);

    void updateAttributes(const py::dict& attributes);
    void preSave(CableEngine&);
    void postSave(CableEngine&);
    void postLoad(CableEngine&);

    py::tuple add(const py::object& newNodes, const py::object& newSlopes, const py::object& newEnds,
                  const py::object& newNext, int newKind, const py::object& newLength, Real newEa, Real newEi,
                  Real newRhoA, Real newDamping, Real newMassDamping);
    void cover(int first, Real thickness, int parts, bool fixedPlaces, bool ownToo, const py::object& newRun,
               const py::object& newArc, const py::object& newClosed);
    vector<Body::id_t> addBodies(int first, const shared_ptr<Material>& material, int mask);
    void madeOf(int first, int material, bool bends);
    void begin();
    void commit();
    void rollback();
    void fix(int node);
    void clamp(int element, int end);
    void follow(int node, Body::id_t id);
    void followSlope(int element, int end);
    void slide(int node, const Vector3r& direction);
    void carry(int node, Body::id_t id, const Vector3r& at);
    void load(int node, const Vector3r& force);
    void tie(int node, int other);
    void release(int node);
    void note(int number, const string& text);
    int wind(int drum, int far, int wound, Real inertia);
    void setWinch(int winch, const py::object& speed, Real force, Real brake, Real least, Real most);
    py::dict winch(int number) const;
    int tied(int node) const;
    bool wound(int node) const;
    vector<int> elementsAt(int node) const;
    py::object state(int firstNode, int nodes, int firstElement, int elements) const;
    void setVelocities(int firstNode, const py::object& ofNodes, int firstElement, const py::object& ofSlopes);
    Vector3r point(int element, Real xi);
    Vector3r pointVelocity(int element, Real xi);
    Real tension(int element, Real xi);
    py::tuple maxTension(int first, int last, int parts);
    Real strain(int element, Real xi);
    Vector3r reaction(int node);
    Vector3r moment(int node);
    void needForces();
    py::dict energy(int first, int last);
    py::tuple momentum();
    Real criticalTimeStep();
    void relax(Real tolerance, int iterations);
    void check();
    void checkIntegrator();
    py::list overlaps(Real part);
    void build();
    int getStride() const { return ancf_stride(nNodes, nElements()); }
    vector<Real> getPosition() const { return position; }
    vector<Real> getVelocity() const { return velocity; }
    void setPosition(const vector<Real>& value) { setField(position, "position", value); }
    void setVelocity(const vector<Real>& value) { setField(velocity, "velocity", value); }
    bool coupled();
    int asleep() const { return touching.asleep(*this); }
    int nElements() const { return static_cast<int>(length.size()); }

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(CableEngine, GlobalEngine,
        "Moves cables and nets of ANCF elements or springs, solves their contacts, and carries bodies with their knots. "
        "Between InteractionLoop and NewtonIntegrator. Filled by the Python classes Cable and Net of the package ancf.",
        ((string, integrator, "leapfrog", Attr::triggerPostLoad, "'leapfrog'; 'implicit' (generalised-alpha, steps as long as accuracy allows; knows no contact, nor bodies off their centre) or 'rk4' (a reference: four force evaluations; knows neither)."))
        ((Real, spectralRadius, .9, Attr::triggerPostLoad, "Of implicit steps: factor by which a step damps motions that it cannot resolve, 0 to 1 (nothing is lost)."))
        ((int, substeps, 0, Attr::triggerPostLoad, "Steps of the cable inside one O.dt, contacts acting in each, at most 1000; 0: as many as it needs."))
        ((int, family, 0, Attr::readonly, "Number of this engine, unique in the scene."))
        ((int, nNodes, 0, Attr::readonly, "Number of nodes."))
        ((vector<Real>, position, , , "Positions of nodes [m] and slopes [-]: blocks x, y, z of `stride`, in each the nodes, the slopes at the starts of all elements, those at the ends."))
        ((vector<Real>, velocity, , , "Their rates at the last half step, with implicit steps at the time of the positions, in the same order [m/s, 1/s]."))
        ((vector<Real>, acceleration, , Attr::readonly, "What implicit steps carry along besides: accelerations, in the same order; empty with other integrators [m/s², 1/s²]."))
        ((int, rejectedSteps, 0, Attr::readonly, "Implicit steps, and parts of them, that did not converge and were taken again in halves, since the engine was made ready."))
        ((int, newtonIterations, 0, Attr::readonly, "Newton's iterations in the last implicit step."))
        ((int, stepParts, 0, Attr::readonly, "In how many parts the last implicit step was taken."))
        ((vector<int>, ends, , Attr::readonly, "Start and end node of every element."))
        ((vector<int>, next, , Attr::readonly, "Element into which an element goes on smoothly, or -1."))
        ((vector<int>, kind, , Attr::triggerPostLoad, "Kind of every element: 1 spring, 2 lumped mass, 4 reduced axial rule, 8 exact curvature, 16 engineering strain, added up."))
        ((vector<Real>, length, , Attr::triggerPostLoad, "Unstressed lengths [m]."))
        ((vector<Real>, ea, , Attr::triggerPostLoad, "Axial stiffnesses [N]."))
        ((vector<Real>, ei, , Attr::triggerPostLoad, "Bending stiffnesses [N m²]."))
        ((vector<Real>, rhoA, , Attr::triggerPostLoad, "Masses per length [kg/m]."))
        ((vector<Real>, kelvinVoigt, , Attr::triggerPostLoad, "Kelvin-Voigt times [s]."))
        ((vector<Real>, massDamping, , Attr::triggerPostLoad, "Mass-proportional damping [1/s]."))
        ((vector<int>, elementIds, , Attr::readonly, "Bodies of the elements, -1: touches nothing."))
        ((vector<Real>, radius, , Attr::readonly, "Half the diameters of the elements [m]."))
        ((vector<int>, segments, , Attr::readonly, "Segments of each element, with one place of contact at most."))
        ((vector<int>, points, , Attr::readonly, "1 where places of contact stand at the ends of the segments, as spheres."))
        ((vector<int>, structure, , Attr::readonly, "Cable or net that an element belongs to: its first element."))
        ((vector<int>, selfContact, , Attr::readonly, "1 for elements that touch others of their own cable or net."))
        ((vector<int>, run, , Attr::readonly, "Row of elements in which arc length counts: its first element."))
        ((vector<Real>, arc, , Attr::readonly, "Unstressed length along the row to the elements' starts [m]."))
        ((vector<Real>, closed, , Attr::readonly, "Length of a row that ends where it starts, else 0 [m]."))
        ((string, normal, "nonlinear", Attr::triggerPostLoad, "Normal force of its contacts: 'nonlinear' (Hunt-Crossley), 'hertz' or 'linear' (spring-dashpot)."))
        ((string, friction, "hollars", Attr::triggerPostLoad, "'hollars', 'coulomb' (regularised below $v_{t0}$) or 'none'."))
        ((bool, sleep, true, , "Leaves alone what is far from everything; False changes no bit of any result, and costs time."))
        ((vector<int>, sections, , Attr::readonly, "Elements that follow a material: first and end of each row."))
        ((vector<int>, sectionMaterials, , Attr::readonly, "Their materials' ids in O.materials."))
        ((vector<int>, sectionBends, , Attr::readonly, "1 where the bending stiffness follows as well."))
        ((vector<Real>, sectionYoung, , Attr::readonly, "The materials' young that ea and ei go with [Pa]."))
        ((vector<Real>, sectionDensity, , Attr::readonly, "The materials' density that rhoA goes with [kg/m³]."))
        ((vector<int>, fixedNodes, , Attr::readonly, "Nodes that are fixed."))
        ((vector<int>, clampedEnds, , Attr::readonly, "Slopes that are held, 2 element + end."))
        ((vector<int>, followNodes, , Attr::readonly, "Nodes that follow a body."))
        ((vector<int>, followIds, , Attr::readonly, "The bodies they follow."))
        ((vector<Vector3r>, followAt, , Attr::readonly, "Their places in the bodies' frames [m]."))
        ((vector<int>, followEnds, , Attr::readonly, "Slopes that follow the body that their node follows, 2 element + end."))
        ((vector<Vector3r>, followSlopes, , Attr::readonly, "These slopes in the bodies' frames [-]."))
        ((vector<int>, slideNodes, , Attr::readonly, "Nodes that go along a straight line alone."))
        ((vector<Vector3r>, slideAlong, , Attr::readonly, "Unit vectors along the lines."))
        ((vector<Vector3r>, slideAt, , Attr::readonly, "A point of each line [m]."))
        ((vector<int>, carryNodes, , Attr::readonly, "Nodes that carry a body."))
        ((vector<int>, carryIds, , Attr::readonly, "The bodies they carry."))
        ((vector<Vector3r>, carryAt, , Attr::readonly, "Places of the nodes in the bodies' frames [m]."))
        ((vector<int>, loadNodes, , Attr::readonly, "Nodes with a constant force."))
        ((vector<Vector3r>, loads, , Attr::readonly, "The forces [N]."))
        ((vector<int>, tiedNodes, , Attr::readonly, "Nodes that another one stands for."))
        ((vector<int>, tiedTo, , Attr::readonly, "The ones that stand for them."))
        ((vector<int>, winchExits, , Attr::readonly, "Nodes at which cables leave the drums of their winches."))
        ((vector<int>, winchRows, , Attr::readonly, "Elements of these cables: the last on the drum and the last on the far side, two for each winch."))
        ((vector<int>, winchElements, , Attr::readonly, "First elements outside, one for each winch."))
        ((vector<int>, winchNodes, , Attr::readonly, "Nodes on the far sides of elements of such cables, -1 for others; empty: no winches."))
        ((vector<Real>, winchLengths, , Attr::readonly, "Their unstressed lengths, but for those at the exits [m]."))
        ((vector<int>, winchDoes, , Attr::hidden, "What drums did in the last step: 0 holds, 1 draws, 2 strains, 3 slips."))
        ((vector<int>, winchScripted, , Attr::hidden, "1 where the speed is a Python function of time."))
        ((vector<Real>, winchNumbers, , Attr::hidden, "Law and state of the winches, see CableWinch.cpp."))
        ((vector<string>, record, , Attr::readonly, "What the Cable and Net objects of Python know besides, a line of JSON each; ancf.structures() reads it."))
        ((Real, lastStep, 0, Attr::readonly, "Length of the cable's step before [s], 0 at the start."))
        ((Vector3r, gravity, Vector3r::Zero(), Attr::readonly, "That of NewtonIntegrator, as last seen [m/s²]."))
        ((int, contacts, 0, Attr::readonly, "Places that pressed on something in the last step."))
        ((int, contactSteps, 0, Attr::readonly, "Sub-steps in the last step of those contacts that needed most; 0: nothing could touch."))
        ((int, sweeps, 0, Attr::readonly, "Sweeps and Newton's steps over the friction of the last step, where most were needed."))
        ((Real, normalLeft, 0, Attr::readonly, "What normal forces are off by in the last step, as part of the largest among contacts that feel one another [-]; above 0.1 the run stops."))
        ((Real, frictionLeft, 0, Attr::readonly, "What friction is off by at the end of the last step, as part of the largest friction force among contacts that feel one another [-]: by their coefficients, where these fall with the speed."))
        ((int, frictionUnsolved, 0, Attr::readonly, "Steps so far in which that was more than 0.1."))
        ((Vector3r, twistLeft, Vector3r::Zero(), Attr::readonly, "Moment of friction between cables that are nearly parallel, summed up over time: it would twist them, and a cable has no torsion to take it [N m s]."))
        ((Real, maxPenetration, 0, Attr::readonly, "Deepest penetration of a place so far [m]."))
        ((int, kickedNodes, 0, Attr::hidden, "Nodes that have taken a step, the first ones."))
        ((int, kickedElements, 0, Attr::hidden, "Elements that have taken a step."))
        ((vector<int>, crossPairs, , Attr::hidden, "Contacts between cables that the next step remembers: element, element, segment."))
        ((vector<Real>, crossValues, , Attr::hidden, "Nine values of each: friction [N], places, late impulse [N s²], owed work [J]."))
        ((vector<Real>, watched, , Attr::hidden, "Of the watch over the step: steps taken, those that look next, the bound of all strains and the strain that automatic steps have room for."))
        ((vector<Real>, openAccounts, , Attr::hidden, "Number of the last step with energies tracked, and what of it the next one counts: height, elastic energy, damping and friction of contacts, damping of cables, lift of bodies [J]."))
        ((Real, energyTolerance, .02, Attr::triggerPostLoad, "Energy watch: share of `energyScale` by which what the cables and their contacts store, give and lose may differ from the work done on them; beyond it the run stops. inf: no watch."))
        ((Real, energyOff, 0, Attr::readonly, "That difference when it was last looked at, above 0: gained. Without O.trackEnergy it goes down by what damping of the cables takes out [J]."))
        ((Real, energyScale, 0, Attr::readonly, "Largest of their energies and works so far [J]."))
        ((vector<Real>, balance, , Attr::hidden, "Sums of the energy watch."))
        ((vector<Vector3r>, carryReaction, , Attr::readonly, "Forces of the carried bodies on their nodes in the last step [N].")),
        timingDeltas = shared_ptr<TimingDeltas>(new TimingDeltas);,
        .add_property("position", &CableEngine::getPosition, &CableEngine::setPosition, "Positions of nodes [m] and slopes [-]: blocks x, y, z of `stride`, in each the nodes, the slopes at the starts of all elements, those at the ends. ValueError for another length, or what is not finite.")
        .add_property("velocity", &CableEngine::getVelocity, &CableEngine::setVelocity, "Their rates at the last half step, with implicit steps at the time of the positions, in the same order [m/s, 1/s]. ValueError likewise.")
        .add_property("stride", &CableEngine::getStride, "Length of a block of `position`.")
        .add_property("nElements", &CableEngine::nElements, "Number of elements.")
        .add_property("coupled", &CableEngine::coupled, "Carries a body off its centre or on a guide, which allows no sub-steps.")
        .add_property("asleep", &CableEngine::asleep, "Elements whose bodies are far from everything: nothing is computed for their contact.")
        .def("add", &CableEngine::add, (py::arg("nodes"), py::arg("slopes"), py::arg("ends"), py::arg("next"), py::arg("kind"), py::arg("length"), py::arg("ea"), py::arg("ei"), py::arg("rhoA"), py::arg("damping"), py::arg("massDamping") = 0.),
             "Adds a cable of n nodes and e elements: numpy arrays nodes (n, 3) [m], slopes (2 e, 3), start and end of each element, ends (e, 2) and next (e), int32, counted from 0 in this call, kind, length (e) [m], ea [N], ei [N m²], rhoA [kg/m], damping [s], massDamping [1/s]. Returns (first node, first element). ValueError on bad values.")
        .def("cover", &CableEngine::cover, (py::arg("first"), py::arg("radius"), py::arg("segments"), py::arg("points"), py::arg("selfContact"), py::arg("run"), py::arg("arc"), py::arg("closed")),
             "Tells of the elements from `first` on, a cable or net added last, what they show to the outside: run (int32, counted from 0), arc [m] and closed [m] are numpy arrays with a value each. ValueError on bad values.")
        .def("addBodies", &CableEngine::addBodies, (py::arg("first"), py::arg("material"), py::arg("mask")), "Puts a body into the scene for each element from `first` on. Returns their ids.")
        .def("madeOf", &CableEngine::madeOf, (py::arg("first"), py::arg("material"), py::arg("bends")), "Lets the elements from `first` on, added last, follow the material of O.materials with an id: an edit of its young or density changes ea, rhoA and, where it bends, ei in the same ratio.")
        .def("begin", &CableEngine::begin, "Remembers what the engine is made of.")
        .def("commit", &CableEngine::commit, "Keeps what was made since begin().")
        .def("rollback", &CableEngine::rollback, "Takes back what was made since begin().")
        .def("fix", &CableEngine::fix, (py::arg("node")), "Holds a node in place.")
        .def("clamp", &CableEngine::clamp, (py::arg("element"), py::arg("end")), "Holds the slope at an element's start (0) or end (1).")
        .def("follow", &CableEngine::follow, (py::arg("node"), py::arg("id")), "Keeps a node at its place in a body's frame.")
        .def("followSlope", &CableEngine::followSlope, (py::arg("element"), py::arg("end")), "Keeps the slope at an element's start (0) or end (1) as it is in the frame of the body that its node follows.")
        .def("slide", &CableEngine::slide, (py::arg("node"), py::arg("direction")), "Lets a node go along a straight line alone.")
        .def("carry", &CableEngine::carry, (py::arg("node"), py::arg("id"), py::arg("at")), "Fastens a body's point `at` (in its frame, [m]) to a node.")
        .def("load", &CableEngine::load, (py::arg("node"), py::arg("force")), "Puts a constant force [N] on a node; zero takes it off.")
        .def("tie", &CableEngine::tie, (py::arg("node"), py::arg("other")), "Makes two nodes one, the first.")
        .def("release", &CableEngine::release, (py::arg("node")), "Frees a node, and the slopes at it, from fix, clamp, follow, followSlope, slide and load.")
        .def("note", &CableEngine::note, (py::arg("number"), py::arg("text")), "Replaces an item of record, or adds one at its end.")
        .def("wind", &CableEngine::wind, (py::arg("drum"), py::arg("far"), py::arg("wound"), py::arg("inertia")), "Winds so many elements of a row of springs, from `drum` to `far`, on a drum at the node where it begins; inertia: the drum's over the square of its radius [kg]. Returns the winch's number. ValueError on bad values.")
        .def("setWinch", &CableEngine::setWinch, (py::arg("winch"), py::arg("speed"), py::arg("force"), py::arg("brake"), py::arg("least"), py::arg("most")), "What a winch does: draws at a speed [m/s], a number or a function of time, with a force [N], and slips above its brake's [N], between two unstressed lengths outside [m]. ValueError on bad values.")
        .def("winch", &CableEngine::winch, (py::arg("number")), "What a winch did in the last step, as dict does, tension [N], rate of the length outside [m/s], length outside and wound [m], work on the cable and energy by nodes that came and went [J], least and most [m].")
        .def("tied", &CableEngine::tied, (py::arg("node")), "The node that stands for a node.")
        .def("wound", &CableEngine::wound, (py::arg("node")), "Whether a node is on the drum of a winch.")
        .def("elementsAt", &CableEngine::elementsAt, (py::arg("node")), "Elements that meet at a node.")
        .def("state", &CableEngine::state, (py::arg("firstNode"), py::arg("nodes"), py::arg("firstElement"), py::arg("elements")),
             "So many nodes from one on, each where the one is that stands for it [m], and the slopes of so many elements, start and end of each [-]: 3 numbers each, for numpy.frombuffer.")
        .def("setVelocities", &CableEngine::setVelocities, (py::arg("firstNode"), py::arg("nodes"), py::arg("firstElement"), py::arg("slopes")),
             "Sets velocities of nodes from one on [m/s] and rates of slopes from those of an element on, start and end of each [1/s]: numpy arrays (n, 3) and (2 e, 3).")
        .def("point", &CableEngine::point, (py::arg("element"), py::arg("xi")), "Position [m].")
        .def("pointVelocity", &CableEngine::pointVelocity, (py::arg("element"), py::arg("xi")), "Velocity [m/s].")
        .def("tension", &CableEngine::tension, (py::arg("element"), py::arg("xi")), "Tension EA eps |r'|, damping included [N].")
        .def("maxTension", &CableEngine::maxTension, (py::arg("first"), py::arg("last"), py::arg("parts")), "Largest tension of the elements first .. last-1, over parts + 1 places of each: (tension [N], element, xi).")
        .def("strain", &CableEngine::strain, (py::arg("element"), py::arg("xi")), "Strain of the element's kind, Green's or engineering strain [-].")
        .def("reaction", &CableEngine::reaction, (py::arg("node")), "Force on the cable that holds or carries a node, in the last step [N]. ValueError for a free node.")
        .def("moment", &CableEngine::moment, (py::arg("node")), "Moment on the cable by what holds the slopes at a node, in the last step [N m]. ValueError where none is held.")
        .def("energy", &CableEngine::energy, (py::arg("first"), py::arg("last")), "Energies [J] of the elements first .. last-1 as dict kinetic, axial, bending, gravity; carried masses not counted.")
        .def("momentum", &CableEngine::momentum, "(linear [kg m/s], angular about the origin [kg m²/s]), with the masses carried at knots.")
        .def("criticalTimeStep", &CableEngine::criticalTimeStep, "Stable step of the cables at their strain now, at least 0.1, whether they touch or not [s].")
        .def("relax", &CableEngine::relax, (py::arg("tolerance"), py::arg("iterations")), "Moves the cables to static equilibrium, on what they lie on, without friction; RuntimeError if there is none, or a body that they press on may move.")
        .def("check", &CableEngine::check, "Refuses what cables may meet and cannot compute: cables of other engines, bodies of other shapes, without size, elastic constants, or a mass to move with. RuntimeError that names the body. Done by ancf.check().")
        .def("checkIntegrator", &CableEngine::checkIntegrator, "ValueError for what implicit steps cannot carry, if they are chosen: contact, and bodies off their centre. Done by ancf.engines() and at the first step.")
        .def("overlaps", &CableEngine::overlaps, (py::arg("part")), "What cables, and spheres that knots carry, overlap now by more than a part of the smaller radius: tuples of an element or carried sphere, a body, the place [m], the depth and the smaller radius [m].")
        .def("build", &CableEngine::build, "Checks everything and gets ready; done by itself at the first step.")
        .def("updateAttrs", &CableEngine::updateAttributes, (py::arg("attributes")), "Sets attributes from a dict.")
        .def(Guarded())
    )
    // clang-format on
};
REGISTER_SERIALIZABLE(CableEngine);

} // namespace yade
