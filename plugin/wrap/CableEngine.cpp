// SPDX-License-Identifier: GPL-2.0-or-later
// What the cables are made of, and what holds them.
#include "CableEngine.hpp"

#include "Attributes.hpp"
#include "CableNodes.hpp"
#include "Drive.hpp"
#include "Guard.hpp"
#include "numbers.hpp"
#include "text.hpp"

#include <core/Omega.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace yade {

YADE_PLUGIN((CableEngine))

Scene& CableEngine::theScene() const { return *Omega::instance().getScene(); } // ours may be that of before a load

void CableEngine::refuse(const string& why) const { throw std::runtime_error(text("CableEngine ", family, ": ", why)); }

CableEngine* CableEngine::of(const Scene& scene, int family) {
    for (const auto& engine : scene.engines)
        if (auto* cables = dynamic_cast<CableEngine*>(engine.get()); cables && cables->family == family) return cables;
    return nullptr;
}

shared_ptr<const CableView> CableEngine::viewOf(const Scene& scene, int family) {
    const Guard guard;
    CableEngine* const cables = of(scene, family);
    if (!cables) return nullptr;
    try {
        cables->scene = const_cast<Scene*>(&scene); // in the first step after loading, it still has the old one
        if (!cables->model) cables->build();
        cables->checkPartners();
        cables->touching.planFor(*cables, scene.dt);
    } catch (const std::exception&) {
        return nullptr; // it tells in its own step
    }
    const auto view = cables->touching.view();
    view->use();
    return view;
}

// Functors of this step may read it, in other threads.
void CableEngine::dropModel() {
    touching.reset(std::move(model));
    implicit.reset();
}

// ---------------------------------------------------------------- engines of scenes that are gone

namespace {
    vector<CableEngine*>& allEngines() {
        static auto* const all = new vector<CableEngine*>; // outlives the last engine
        return *all;
    }
} // namespace

CableEngine::Listed::Listed(CableEngine* one) : engine(one) {
    const Guard guard;
    allEngines().push_back(one);
}

CableEngine::Listed::~Listed() {
    const Guard guard;
    auto& all = allEngines();
    all.erase(std::remove(all.begin(), all.end(), engine), all.end());
}

// YADE never frees engines that were in O.engines: those of scenes that are gone let go of what they hold.
void CableEngine::atHome() {
    const boost::weak_ptr<Scene> none;
    home = Omega::instance().getScene();
    for (CableEngine* engine : allEngines()) {
        const bool began = engine->home.owner_before(none) || none.owner_before(engine->home);
        if (began && engine->home.expired()) engine->forget();
        // One that this takes the place of: elements look for the engine of their family anew.
        const bool here = !engine->home.owner_before(home) && !home.owner_before(engine->home);
        if (engine != this && here && engine->family == family) engine->changed();
    }
}

void CableEngine::forget() {
    changed();
    touching = CableContacts();
    home.reset();
    for (vector<Real>* list : {&position, &velocity,     &acceleration,   &length,       &ea,
                               &ei,       &rhoA,         &kelvinVoigt,    &massDamping,  &radius,
                               &arc,      &closed,       &crossValues,    &openAccounts, &watched,
                               &balance,  &sectionYoung, &sectionDensity, &winchLengths, &winchNumbers})
        vector<Real>().swap(*list);
    vector<string>().swap(record);
    for (vector<int>* list :
         {&ends,          &next,       &kind,       &elementIds,       &segments,     &points,     &structure,
          &selfContact,   &run,        &fixedNodes, &clampedEnds,      &followNodes,  &followEnds, &followIds,
          &carryNodes,    &carryIds,   &loadNodes,  &tiedNodes,        &tiedTo,       &crossPairs, &carrierOfBody,
          &standsFor,     &driven,     &sections,   &sectionMaterials, &sectionBends, &winchExits, &winchRows,
          &winchElements, &winchNodes, &winchDoes,  &winchScripted,    &slideNodes})
        vector<int>().swap(*list);
    for (vector<Vector3r>* list :
         {&followAt, &followSlopes, &slideAlong, &slideAt, &carryAt, &loads, &carryReaction, &carriedForce})
        vector<Vector3r>().swap(*list);
    for (auto* list : {&carried, &followed}) vector<Held>().swap(*list);
    vector<Shown>().swap(elementBodies);
    vector<Looked>().swap(lookedAt);
    vector<Worked>().swap(worked);
    vector<Led>().swap(led);
    vector<Pulls>().swap(pulls);
    forgotten = true;
    nNodes = kickedNodes = kickedElements = 0;
    lastStep = 0;
}

// ---------------------------------------------------------------- what it is made of

void CableEngine::moveState(vector<Real>&& x, vector<Real>&& v) {
    touching.keep(std::make_shared<const vector<Real>>(std::move(position)));
    touching.keep(std::make_shared<const vector<Real>>(std::move(velocity)));
    position = std::move(x);
    velocity = std::move(v);
}

void CableEngine::updateAttributes(const py::dict& attributes) {
    moveState(vector<Real>(position), vector<Real>(velocity));
    pyUpdateAttrs(attributes);
}

void CableEngine::changed() {
    dropModel();
    pairsChecked = partnersChecked = balanced = false;
    openAccounts.clear();
}

void CableEngine::preSave(CableEngine&) {
    const Guard guard; // O.save may come while O.run goes on
    touching.recall(crossPairs, crossValues);
    keepBalance();
}

void CableEngine::postSave(CableEngine&) {
    const Guard guard;
    crossPairs.clear();
    crossValues.clear();
}

void CableEngine::postLoad(CableEngine&) {
    sound = false;
    standsFor.clear();
    carried.clear();
    followed.clear();
    vector<Real> open = std::move(openAccounts); // they go on
    changed();
    openAccounts = std::move(open);
    needSound();
    if (crossPairs.empty()) return;
    touching.remember(crossPairs, crossValues);
    postSave(*this);
}

void CableEngine::checkNode(int node, const char* what) const {
    needSound();
    if (node < 0 || node >= nNodes)
        throw std::out_of_range(text("CableEngine.", what, ": node ", node, " does not exist, there are ", nNodes));
}

// Bodies of elements that were there, of which none is, tell of a scene that is gone.
void CableEngine::checkHome() const {
    const BodyContainer& bodies = *theScene().bodies;
    Body::id_t one = -1;
    for (const Body::id_t id : elementIds) {
        if (id < 0) continue;
        one = id;
        if (!bodies.exists(id)) continue;
        const auto* element = dynamic_cast<const CableElement*>(bodies[id]->shape.get());
        if (element && element->family == family) return;
    }
    if (one >= 0)
        refuse(text("body ", one,
                    " of its elements is not in O.bodies, nor any other: it belongs to a scene that "
                    "O.reset() or O.load() has taken away; make a new one"));
}

const char* CableEngine::claimOf(int node) const {
    return has(fixedNodes, node)    ? "fixed"
           : has(followNodes, node) ? "following a body"
           : has(slideNodes, node)  ? "sliding along a line"
           : has(carryNodes, node)  ? "carrying a body"
                                    : nullptr;
}

void CableEngine::checkUnclaimed(int node) const {
    if (const char* claim = claimOf(node))
        throw std::invalid_argument(text("CableEngine: node ", node, " is ", claim, " already: release it first"));
}

namespace {
    // The blocks of a field with room for more nodes and elements.
    vector<Real> widen(const vector<Real>& field, int nodes, int elements, int newNodes, int newElements) {
        const int from = ancf_stride(nodes, elements), to = ancf_stride(newNodes, newElements);
        vector<Real> wide(3 * static_cast<size_t>(to), 0);
        for (int c = 0; c < 3 && !field.empty(); ++c) {
            const Real* source = field.data() + c * from;
            Real* target = wide.data() + c * to;
            std::copy_n(source, nodes, target);
            std::copy_n(source + nodes, elements, target + newNodes);
            std::copy_n(source + nodes + elements, elements, target + newNodes + newElements);
        }
        return wide;
    }
} // namespace

py::tuple CableEngine::add(const py::object& newNodes, const py::object& newSlopes, const py::object& newEnds,
                           const py::object& newNext, int newKind, const py::object& newLength, Real newEa, Real newEi,
                           Real newRhoA, Real newDamping, Real newMassDamping) {
    refuseWhileRunning("CableEngine.add");
    needSound();
    checkHome();
    const Numbers<Real> nodes(newNodes, "CableEngine.add: nodes"), slopes(newSlopes, "CableEngine.add: slopes"),
        lengths(newLength, "CableEngine.add: length");
    const Numbers<int> endsOf(newEnds, "CableEngine.add: ends"), nextOf(newNext, "CableEngine.add: next");
    const int firstNode = nNodes, firstElement = nElements(), n = static_cast<int>(nodes.size()) / 3,
              e = static_cast<int>(lengths.size());
    if (n < 2 || nodes.size() % 3 != 0 || e < 1 || slopes.size() != 6 * lengths.size() ||
        endsOf.size() != 2 * lengths.size() || nextOf.size() != lengths.size())
        throw std::invalid_argument(text("CableEngine.add: ", e,
                                         " lengths need 3 numbers for each of 2 nodes at least, ", 6 * e,
                                         " of slopes, ", 2 * e, " ends and ", e, " next; got ", nodes.size(), ", ",
                                         slopes.size(), ", ", endsOf.size(), " and ", nextOf.size()));
    const Attributes given("CableEngine.add");
    for (const auto& [name, numbers] :
         {std::pair("nodes", &nodes), std::pair("slopes", &slopes), std::pair("length", &lengths)})
        given.finiteEach(name, *numbers);
    for (const auto& [name, value] : {std::pair("ea", newEa), std::pair("ei", newEi), std::pair("rhoA", newRhoA),
                                      std::pair("damping", newDamping), std::pair("massDamping", newMassDamping)})
        given.need(finite(value), name, value, "finite, and below 1e100");
    vector<ancf_element> elements;
    for (const Real l : lengths) elements.push_back({newKind, l, newEa, newEi, newRhoA, newDamping, newMassDamping});

    const int allNodes = nNodes + n, all = firstElement + e, stride = ancf_stride(allNodes, all);
    vector<Real> x = widen(position, nNodes, firstElement, allNodes, all),
                 v = widen(velocity, nNodes, firstElement, allNodes, all);
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < n; ++i) x[c * stride + firstNode + i] = nodes[3 * i + c];
        for (int i = 0; i < e; ++i) {
            x[c * stride + allNodes + firstElement + i] = slopes[6 * i + c];
            x[c * stride + allNodes + all + firstElement + i] = slopes[6 * i + 3 + c];
        }
    }
    // The new part alone, to refuse it before it is in.
    const ancf_def def = {n, e, elements.data(), endsOf.begin(), nextOf.begin(), nullptr, nullptr, 0, nullptr};
    const int newStride = ancf_stride(n, e);
    vector<Real> newX(3 * static_cast<size_t>(newStride), 0);
    for (int c = 0; c < 3; ++c) {
        Real* block = newX.data() + c * newStride;
        for (int i = 0; i < n; ++i) block[i] = nodes[3 * i + c];
        for (int i = 0; i < e; ++i) block[n + i] = slopes[6 * i + c] + slopes[6 * i + 3 + c];
    }
    checkDef("CableEngine.add", def, newX.data(), newX.data());
    vector<bool> used(static_cast<size_t>(n), false);
    for (const int k : endsOf) used[k] = true;
    if (const auto lone = std::find(used.begin(), used.end(), false); lone != used.end())
        given.refuse("ends: node ", lone - used.begin(), " of nodes is in no element: leave it out");

    moveState(std::move(x), std::move(v));
    for (const int k : endsOf) ends.push_back(firstNode + k);
    for (const int k : nextOf) next.push_back(k < 0 ? -1 : firstElement + k);
    kind.insert(kind.end(), e, newKind);
    length.insert(length.end(), lengths.begin(), lengths.end());
    ea.insert(ea.end(), e, newEa);
    ei.insert(ei.end(), e, newEi);
    rhoA.insert(rhoA.end(), e, newRhoA);
    kelvinVoigt.insert(kelvinVoigt.end(), e, newDamping);
    massDamping.insert(massDamping.end(), e, newMassDamping);
    if (!winchExits.empty()) {
        winchNodes.resize(length.size(), -1);
        winchLengths.resize(length.size(), 0);
    }
    nNodes = allNodes;
    atHome();
    changed();
    return py::make_tuple(firstNode, firstElement);
}

void CableEngine::cover(int first, Real thickness, int parts, bool fixedPlaces, bool ownToo, const py::object& newRun,
                        const py::object& newArc, const py::object& newClosed) {
    needSound();
    const Numbers<int> runs(newRun, "CableEngine.cover: run");
    const Numbers<Real> arcs(newArc, "CableEngine.cover: arc"), closedRuns(newClosed, "CableEngine.cover: closed");
    const size_t n = runs.size(), old = radius.size();
    if (first != static_cast<int>(old) || old + n != length.size() || arcs.size() != n || closedRuns.size() != n)
        throw std::invalid_argument(text("CableEngine.cover: first = ", first, " with ", n, " runs, ", arcs.size(),
                                         " arcs and ", closedRuns.size(), " closed: must be those of the ",
                                         length.size() - old, " elements added last, from ", old, " on"));
    const Attributes all("CableEngine.cover");
    all.need(finite(thickness) && thickness > 0, "radius", thickness, "finite and above 0 [m]");
    all.need(parts >= 1 && parts <= segmentsMost, "segments", parts, text("1 to ", segmentsMost));
    all.within("run", runs, 0, static_cast<int>(n), "the first element of a row");
    all.notNegative("arc", arcs);
    all.notNegative("closed", closedRuns);
    elementIds.resize(old + n, -1);
    radius.resize(old + n, thickness);
    segments.resize(old + n, parts);
    points.resize(old + n, fixedPlaces);
    structure.resize(old + n, first);
    selfContact.resize(old + n, ownToo);
    for (const int k : runs) run.push_back(first + k);
    arc.insert(arc.end(), arcs.begin(), arcs.end());
    closed.insert(closed.end(), closedRuns.begin(), closedRuns.end());
    changed();
}

vector<Body::id_t> CableEngine::addBodies(int first, const shared_ptr<Material>& material, int mask) {
    refuseWhileRunning("CableEngine.addBodies");
    needSound();
    if (first < 0 || radius.size() != length.size())
        throw std::invalid_argument(text("CableEngine.addBodies: first = ", first, ": cover() was told of ",
                                         radius.size(), " of ", length.size(), " elements"));
    const auto stride = getStride(), n = nElements();
    elementIds.resize(length.size(), -1);
    for (int e = first; e < n; ++e)
        if (elementIds[e] >= 0)
            throw std::invalid_argument(text("CableEngine.addBodies: first = ", first, ": element ", e, " has body ",
                                             elementIds[e], " already"));
    if (!dynamic_cast<const HollarsMat*>(material.get()))
        throw std::invalid_argument(text("CableEngine.addBodies: material is ",
                                         material ? "a " + material->getClassName() : "None",
                                         ": must be a HollarsMat"));
    vector<Body::id_t> ids;
    for (int e = first; e < n; ++e) {
        const auto at = [&](int place) { return nodeOf(position.data(), stride, place); };
        Vector3r middle = .5 * (at(ends[2 * e]) + at(ends[2 * e + 1]));
        if (!(kind[e] & ANCF_SPRING)) middle += length[e] / 8 * (at(nNodes + e) - at(nNodes + n + e));
        const auto shape = boost::make_shared<CableElement>();
        shape->element = e;
        shape->family = family;
        shape->radius = radius[e];
        const auto body = boost::make_shared<Body>();
        body->shape = shape;
        body->material = material;
        body->groupMask = mask;
        body->state->pos = body->state->refPos = middle;
        body->state->mass = 0;
        body->state->blockedDOFs = State::DOF_ALL;
        ids.push_back(elementIds[e] = theScene().bodies->insert(body));
    }
    changed();
    return ids;
}

namespace {
    // What is wound on a drum stands for nothing yet.
    void checkOutside(const CableEngine& cable, int node, const char* what) {
        if (cable.wound(node))
            throw std::invalid_argument(
                text("CableEngine.", what, ": node ", node, " is wound on the drum of a winch: pay it out first"));
    }
} // namespace

void CableEngine::fix(int node) {
    checkNode(node, "fix");
    checkOutside(*this, node, "fix");
    checkUnclaimed(node = tied(node));
    fixedNodes.push_back(node);
    changed();
}

// An end of an element that has a slope.
void CableEngine::checkSlope(const char* what, int element, int end) const {
    needSound();
    if (element < 0 || element >= nElements() || (end != 0 && end != 1))
        throw std::out_of_range(text("CableEngine.", what, ": element ", element, ", end ", end, ": there are ",
                                     nElements(), " elements with the ends 0 and 1"));
    if (kind[element] & ANCF_SPRING)
        throw std::invalid_argument(text("CableEngine.", what, ": a spring has no slope: use model='ancf'"));
}

void CableEngine::clamp(int element, int end) {
    checkSlope("clamp", element, end);
    if (!has(clampedEnds, 2 * element + end)) clampedEnds.push_back(2 * element + end);
    changed();
}

void CableEngine::follow(int node, Body::id_t id) {
    refuseWhileRunning("CableEngine.follow");
    checkNode(node, "follow");
    checkOutside(*this, node, "follow");
    checkUnclaimed(node = tied(node));
    const Body& body = followedBody(id);
    followNodes.push_back(node);
    followIds.push_back(id);
    followAt.push_back(body.state->ori.conjugate() * (nodeOf(position.data(), getStride(), node) - body.state->pos));
    changed();
}

void CableEngine::followSlope(int element, int end) {
    refuseWhileRunning("CableEngine.followSlope");
    checkSlope("followSlope", element, end);
    const int number = 2 * element + end;
    const Body::id_t id = followedAt(ends[number]);
    if (id < 0)
        throw std::invalid_argument(text("CableEngine.followSlope: element ", element, ", end ", end, ": its node ",
                                         ends[number], " follows no body: follow() first"));
    if (has(followEnds, number)) return;
    const State& state = *followedBody(id).state;
    followEnds.push_back(number);
    followSlopes.push_back(state.ori.conjugate() *
                           nodeOf(position.data(), getStride(), nNodes + end * nElements() + element));
    changed();
}

void CableEngine::slide(int node, const Vector3r& direction) {
    checkNode(node, "slide");
    checkOutside(*this, node, "slide");
    checkUnclaimed(node = tied(node));
    Attributes(text("CableEngine.slide: node ", node))
        .need(finite(direction) && direction.norm() > 0, "direction", direction, "finite, below 1e100 and not 0");
    slideNodes.push_back(node);
    slideAlong.push_back(direction.normalized());
    slideAt.push_back(nodeOf(position.data(), getStride(), node));
    changed();
}

// Lines go where their nodes were put.
void CableEngine::moveLines() {
    for (size_t i = 0; i < slideNodes.size(); ++i) slideAt[i] = nodeOf(position.data(), getStride(), slideNodes[i]);
}

vector<ancf_slide> CableEngine::slides() const {
    vector<ancf_slide> all;
    for (size_t i = 0; i < slideNodes.size(); ++i) {
        const Vector3r &d = slideAlong[i], &at = slideAt[i];
        all.push_back({slideNodes[i], {d[0], d[1], d[2]}, {at[0], at[1], at[2]}});
    }
    return all;
}

void CableEngine::carry(int node, Body::id_t id, const Vector3r& place) {
    refuseWhileRunning("CableEngine.carry");
    checkNode(node, "carry");
    checkOutside(*this, node, "carry");
    checkUnclaimed(node = tied(node));
    const Body& body = carriedBody(id);
    State& state = *body.state;
    if (state.blockedDOFs == State::DOF_ALL && !placedByDrive(theScene(), body))
        throw std::invalid_argument(text("CableEngine.carry: body ", id, " is blocked in all freedoms: use follow"));
    const Real gap = (state.pos + state.ori * place - nodeOf(position.data(), getStride(), node)).norm();
    if (!(gap <= 1e-6 * (1 + state.pos.norm())))
        throw std::invalid_argument(text("CableEngine.carry: node ", node, " is ", gap,
                                         " m from the point `at` of body ", id, ": put the body there first"));
    for (size_t i = 0; i < carryIds.size(); ++i)
        if (carryIds[i] == id && place.norm() == 0 && carryAt[i].norm() == 0 && !placedByDrive(theScene(), body))
            throw std::invalid_argument(text("CableEngine.carry: body ", id, " is carried at its centre by node ",
                                             carryNodes[i], " already: tie() node ", node, " to that one"));
    // Free to move and held at its centre, the body is no more than mass at the node.
    if (place.norm() == 0 && !(state.blockedDOFs & State::DOF_XYZ)) {
        if (has(carryIds, id))
            throw std::invalid_argument(text("CableEngine.carry: body ", id, " is carried at its centre already"));
        if (kept) freedomsBefore.emplace_back(id, state.blockedDOFs);
        state.blockedDOFs |= State::DOF_XYZ;
    }
    carryNodes.push_back(node);
    carryIds.push_back(id);
    carryAt.push_back(place);
    changed();
}

void CableEngine::load(int node, const Vector3r& force) {
    checkNode(node, "load");
    checkOutside(*this, node, "load");
    Attributes(text("CableEngine.load: node ", node))
        .need(finite(force), "force", force, "finite, and below 1e100 [N]");
    node = tied(node);
    const auto found = std::find(loadNodes.begin(), loadNodes.end(), node);
    if (found != loadNodes.end()) {
        Vector3r& now = loads[static_cast<size_t>(found - loadNodes.begin())];
        bookLoad(node, force - now);
        now = force;
        return;
    }
    bookLoad(node, force);
    loadNodes.push_back(node);
    loads.push_back(force);
}

int CableEngine::tied(int node) const {
    checkNode(node, "tied");
    const bool none = standsFor.empty();
    for (int i = static_cast<int>(standsFor.size()); i < nNodes; ++i) standsFor.push_back(i);
    for (size_t i = 0; none && i < tiedNodes.size(); ++i) standsFor[tiedNodes[i]] = tiedTo[i];
    while (standsFor[node] != node) node = standsFor[node] = standsFor[standsFor[node]];
    return node;
}

bool CableEngine::wound(int node) const {
    checkNode(node, "wound");
    for (size_t e = 0; e < winchNodes.size(); ++e)
        if (winchNodes[e] == node && (kind[e] & ANCF_WOUND)) return true;
    return false;
}

vector<int> CableEngine::elementsAt(int node) const {
    checkNode(node, "elementsAt");
    vector<int> found;
    for (int e = 0; e < nElements(); ++e)
        if (ends[2 * e] == node || ends[2 * e + 1] == node) found.push_back(e);
    return found;
}

void CableEngine::checkRange(const char* what, int first, int n, int all) const {
    needSound();
    if (first < 0 || n < 0 || first > all - n)
        throw std::out_of_range(text("CableEngine: ", n, " ", what, " from ", first, " on: there are ", all));
}

py::object CableEngine::state(int firstNode, int nodes, int firstElement, int elements) const {
    checkRange("nodes", firstNode, nodes, nNodes);
    checkRange("elements", firstElement, elements, nElements());
    const size_t size = 3 * (static_cast<size_t>(nodes) + 2 * static_cast<size_t>(elements)) * sizeof(Real);
    const py::object bytes(py::handle<>(PyByteArray_FromStringAndSize(nullptr, static_cast<Py_ssize_t>(size))));
    char* to = PyByteArray_AS_STRING(bytes.ptr());
    const auto give = [&](int place) {
        const Vector3r value = nodeOf(position.data(), getStride(), place);
        std::memcpy(to, value.data(), 3 * sizeof(Real));
        to += 3 * sizeof(Real);
    };
    for (int i = 0; i < nodes; ++i) give(tied(firstNode + i));
    for (int e = firstElement; e < firstElement + elements; ++e) {
        give(nNodes + e);
        give(nNodes + nElements() + e);
    }
    return bytes;
}

void CableEngine::setVelocities(int firstNode, const py::object& ofNodes, int firstElement,
                                const py::object& ofSlopes) {
    const Numbers<Real> nodes(ofNodes, "CableEngine.setVelocities: nodes"),
        slopes(ofSlopes, "CableEngine.setVelocities: slopes");
    if (nodes.size() % 3 != 0 || slopes.size() % 6 != 0)
        throw std::invalid_argument(text("CableEngine.setVelocities: ", nodes.size(), " numbers of nodes and ",
                                         slopes.size(), " of slopes: must be 3 a node and 6 an element"));
    const int n = static_cast<int>(nodes.size() / 3), e = static_cast<int>(slopes.size() / 6), stride = getStride();
    checkRange("nodes", firstNode, n, nNodes);
    checkRange("elements", firstElement, e, nElements());
    const Attributes all("CableEngine.setVelocities");
    all.finiteEach("nodes", nodes);
    all.finiteEach("slopes", slopes);
    for (int i = 0; i < n; ++i)
        setNode(velocity.data(), stride, tied(firstNode + i),
                Vector3r(nodes[3 * i], nodes[3 * i + 1], nodes[3 * i + 2]));
    for (int i = 0; i < 2 * e; ++i)
        setNode(velocity.data(), stride, nNodes + (i % 2) * nElements() + firstElement + i / 2,
                Vector3r(slopes[3 * i], slopes[3 * i + 1], slopes[3 * i + 2]));
    balanced = false;
}

void CableEngine::tie(int node, int other) {
    checkNode(node, "tie");
    checkNode(other, "tie");
    checkOutside(*this, node, "tie");
    checkOutside(*this, other, "tie");
    node = tied(node);
    other = tied(other);
    if (node == other) throw std::invalid_argument(text("CableEngine.tie: node ", node, " with itself"));
    checkUnclaimed(other);
    const Real gap = (nodeOf(position.data(), getStride(), node) - nodeOf(position.data(), getStride(), other)).norm();
    if (gap > 1e-6 * (1 + nodeOf(position.data(), getStride(), node).norm()))
        throw std::invalid_argument(
            text("CableEngine.tie: nodes ", node, " and ", other, " are ", gap, " m apart: they must be at one place"));
    for (int& end : ends)
        if (end == other) end = node;
    for (int& loaded : loadNodes)
        if (loaded == other) loaded = node;
    tiedNodes.push_back(other);
    tiedTo.push_back(node);
    standsFor[other] = node;
    changed();
}

void CableEngine::note(int number, const string& text) {
    const size_t at = static_cast<size_t>(number);
    if (number < 0 || at > record.size())
        throw std::out_of_range(yade::text("CableEngine.note: number = ", number, ": there are ", record.size()));
    if (at == record.size()) record.emplace_back();
    record[at] = text;
}

void CableEngine::release(int node) {
    checkNode(node, "release");
    node = tied(node);
    fixedNodes.erase(std::remove(fixedNodes.begin(), fixedNodes.end(), node), fixedNodes.end());
    const auto there = [&](int end) { return ends[static_cast<size_t>(end)] == node; };
    clampedEnds.erase(std::remove_if(clampedEnds.begin(), clampedEnds.end(), there), clampedEnds.end());
    followed.clear();
    for (size_t i = followEnds.size(); i-- > 0;)
        if (there(followEnds[i])) {
            followEnds.erase(followEnds.begin() + static_cast<long>(i));
            followSlopes.erase(followSlopes.begin() + static_cast<long>(i));
        }
    for (size_t i = followNodes.size(); i-- > 0;)
        if (followNodes[i] == node) {
            followNodes.erase(followNodes.begin() + static_cast<long>(i));
            followIds.erase(followIds.begin() + static_cast<long>(i));
            followAt.erase(followAt.begin() + static_cast<long>(i));
        }
    for (size_t i = slideNodes.size(); i-- > 0;)
        if (slideNodes[i] == node) {
            slideNodes.erase(slideNodes.begin() + static_cast<long>(i));
            slideAlong.erase(slideAlong.begin() + static_cast<long>(i));
            slideAt.erase(slideAt.begin() + static_cast<long>(i));
        }
    for (size_t i = loadNodes.size(); i-- > 0;)
        if (loadNodes[i] == node) {
            loadNodes.erase(loadNodes.begin() + static_cast<long>(i));
            loads.erase(loads.begin() + static_cast<long>(i));
        }
    changed();
}

} // namespace yade
