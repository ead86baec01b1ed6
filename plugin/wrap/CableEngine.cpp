// SPDX-License-Identifier: GPL-2.0-or-later
// What the cables are made of, and what holds them.
#include "CableEngine.hpp"

#include "CableNodes.hpp"
#include "Drive.hpp"
#include "numbers.hpp"
#include "text.hpp"

#include <core/Omega.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace yade {

YADE_PLUGIN((CableEngine))
CREATE_LOGGER(CableEngine);

Scene& CableEngine::theScene() const { return *Omega::instance().getScene(); } // ours may be that of before a load

void CableEngine::refuse(const string& why) const { throw std::runtime_error(text("CableEngine ", family, ": ", why)); }

shared_ptr<const CableView> CableEngine::viewOf(const Scene& scene, int family) {
    for (const auto& engine : scene.engines) {
        auto* cables = dynamic_cast<CableEngine*>(engine.get());
        if (!cables || cables->family != family) continue;
        try {
            cables->scene = const_cast<Scene*>(&scene); // in the first step after loading, it still has the old one
            if (!cables->model) cables->build();
            cables->checkPartners();
        } catch (const std::exception&) {
            return nullptr; // it tells in its own step
        }
        return cables->touching.view();
    }
    return nullptr;
}

void CableEngine::changed() {
    touching.reset();
    implicit.reset();
    model.reset();
    pairsChecked = partnersChecked = false;
    openAccounts.clear();
}

namespace {
    int choose(const char* attribute, const string& name, const std::array<const char*, 3>& names) {
        for (int i = 0; i < 3; ++i)
            if (name == names[i]) return i;
        throw std::invalid_argument(text("CableEngine.", attribute, " = '", name, "': must be '", names[0], "', '",
                                         names[1], "' or '", names[2], "'"));
    }
} // namespace

void CableEngine::preSave(CableEngine&) { touching.keep(crossPairs, crossValues); }

void CableEngine::postSave(CableEngine&) {
    crossPairs.clear();
    crossValues.clear();
}

void CableEngine::postLoad(CableEngine&) {
    normalKind = choose("normal", normal, {"linear", "hertz", "nonlinear"});
    frictionKind = choose("friction", friction, {"none", "coulomb", "hollars"});
    standsFor.clear();
    changed();
    if (crossPairs.empty()) return;
    touching.remember(crossPairs, crossValues);
    postSave(*this);
}

void CableEngine::checkNode(int node, const char* what) const {
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

void CableEngine::checkUnclaimed(int node) const {
    const char* claim = has(fixedNodes, node)    ? "fixed"
                        : has(followNodes, node) ? "following a body"
                        : has(carryNodes, node)  ? "carrying a body"
                                                 : nullptr;
    if (claim)
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
                           Real newRhoA, Real newDamping) {
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
    vector<ancf_element> elements;
    for (const Real l : lengths) elements.push_back({newKind, l, newEa, newEi, newRhoA, newDamping});

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
    const ancf_def def = {n, e, elements.data(), endsOf.begin(), nextOf.begin(), nullptr, nullptr};
    const int newStride = ancf_stride(n, e);
    vector<Real> newX(3 * static_cast<size_t>(newStride), 0);
    for (int c = 0; c < 3; ++c) {
        Real* block = newX.data() + c * newStride;
        for (int i = 0; i < n; ++i) block[i] = nodes[3 * i + c];
        for (int i = 0; i < e; ++i) block[n + i] = slopes[6 * i + c] + slopes[6 * i + 3 + c];
    }
    int where = 0;
    const ancf_error error = ancf_model_check(&def, newX.data(), newX.data(), &where);
    if (error)
        throw std::invalid_argument(text("CableEngine.add: element or node ", where, ": ", ancf_error_text(error)));

    position = std::move(x);
    velocity = std::move(v);
    for (const int k : endsOf) ends.push_back(firstNode + k);
    for (const int k : nextOf) next.push_back(k < 0 ? -1 : firstElement + k);
    kind.insert(kind.end(), e, newKind);
    length.insert(length.end(), lengths.begin(), lengths.end());
    ea.insert(ea.end(), e, newEa);
    ei.insert(ei.end(), e, newEi);
    rhoA.insert(rhoA.end(), e, newRhoA);
    kelvinVoigt.insert(kelvinVoigt.end(), e, newDamping);
    nNodes = allNodes;
    changed();
    return py::make_tuple(firstNode, firstElement);
}

void CableEngine::cover(int first, Real thickness, int parts, bool fixedPlaces, bool ownToo, const py::object& newRun,
                        const py::object& newArc, const py::object& newClosed) {
    constexpr int partsMost = 64;
    const Numbers<int> runs(newRun, "CableEngine.cover: run");
    const Numbers<Real> arcs(newArc, "CableEngine.cover: arc"), closedRuns(newClosed, "CableEngine.cover: closed");
    const size_t n = runs.size(), old = radius.size();
    if (first != static_cast<int>(old) || old + n != length.size() || arcs.size() != n || closedRuns.size() != n)
        throw std::invalid_argument(text("CableEngine.cover: first = ", first, " with ", n, " runs, ", arcs.size(),
                                         " arcs and ", closedRuns.size(), " closed: must be those of the ",
                                         length.size() - old, " elements added last, from ", old, " on"));
    if (!(thickness > 0) || !std::isfinite(thickness))
        throw std::invalid_argument(text("CableEngine.cover: radius = ", thickness, ": must be above 0 [m]"));
    if (parts < 1 || parts > partsMost)
        throw std::invalid_argument(text("CableEngine.cover: segments = ", parts, ": must be 1 to ", partsMost));
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
    if (first < 0 || elementIds.size() != length.size())
        throw std::invalid_argument(text("CableEngine.addBodies: first = ", first, ": cover() was told of ",
                                         elementIds.size(), " of ", length.size(), " elements"));
    const auto stride = getStride(), n = nElements();
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

void CableEngine::fix(int node) {
    checkNode(node, "fix");
    checkUnclaimed(node = tied(node));
    fixedNodes.push_back(node);
    changed();
}

void CableEngine::clamp(int element, int end) {
    if (element < 0 || element >= nElements() || (end != 0 && end != 1))
        throw std::out_of_range(text("CableEngine.clamp: element ", element, ", end ", end, ": there are ", nElements(),
                                     " elements with the ends 0 and 1"));
    if (kind[element] & ANCF_SPRING)
        throw std::invalid_argument("CableEngine.clamp: a spring has no slope: use model='ancf'");
    if (!has(clampedEnds, 2 * element + end)) clampedEnds.push_back(2 * element + end);
    changed();
}

void CableEngine::follow(int node, Body::id_t id) {
    checkNode(node, "follow");
    checkUnclaimed(node = tied(node));
    const Body& body = bodyOf(theScene(), id, "follow");
    if (movedBody(theScene(), body).isDynamic() && movedBody(theScene(), body).state->blockedDOFs != State::DOF_ALL)
        throw std::invalid_argument(
            text("CableEngine.follow: body ", id, " moves freely and would not feel the cable: use carry"));
    followNodes.push_back(node);
    followIds.push_back(id);
    followAt.push_back(body.state->ori.conjugate() * (nodeOf(position.data(), getStride(), node) - body.state->pos));
    changed();
}

void CableEngine::carry(int node, Body::id_t id, const Vector3r& place) {
    checkNode(node, "carry");
    checkUnclaimed(node = tied(node));
    const Body& body = bodyOf(theScene(), id, "carry");
    State& state = *body.state;
    if (body.isClumpMember())
        throw std::invalid_argument(
            text("CableEngine.carry: body ", id, " is a clump's member: carry the clump, ", body.clumpId));
    if (!(state.mass > 0))
        throw std::invalid_argument(
            text("CableEngine.carry: body ", id, " has mass ", state.mass, ": must be above 0 [kg]"));
    if (state.blockedDOFs == State::DOF_ALL && !placedByDrive(theScene(), body))
        throw std::invalid_argument(text("CableEngine.carry: body ", id, " is blocked in all freedoms: use follow"));
    const Real gap = (state.pos + state.ori * place - nodeOf(position.data(), getStride(), node)).norm();
    if (!(gap <= 1e-6 * (1 + state.pos.norm())))
        throw std::invalid_argument(text("CableEngine.carry: node ", node, " is ", gap,
                                         " m from the point `at` of body ", id, ": put the body there first"));
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
    if (!std::isfinite(force.sum()))
        throw std::invalid_argument(text("CableEngine.load: force on node ", node, " is not finite"));
    node = tied(node);
    const auto found = std::find(loadNodes.begin(), loadNodes.end(), node);
    if (found != loadNodes.end()) {
        loads[static_cast<size_t>(found - loadNodes.begin())] = force;
        return;
    }
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

vector<int> CableEngine::elementsAt(int node) const {
    vector<int> found;
    for (int e = 0; e < nElements(); ++e)
        if (ends[2 * e] == node || ends[2 * e + 1] == node) found.push_back(e);
    return found;
}

void CableEngine::checkRange(const char* what, int first, int n, int all) const {
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
    for (int i = 0; i < n; ++i)
        setNode(velocity.data(), stride, tied(firstNode + i),
                Vector3r(nodes[3 * i], nodes[3 * i + 1], nodes[3 * i + 2]));
    for (int i = 0; i < 2 * e; ++i)
        setNode(velocity.data(), stride, nNodes + (i % 2) * nElements() + firstElement + i / 2,
                Vector3r(slopes[3 * i], slopes[3 * i + 1], slopes[3 * i + 2]));
}

void CableEngine::tie(int node, int other) {
    checkNode(node, "tie");
    checkNode(other, "tie");
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

void CableEngine::release(int node) {
    checkNode(node, "release");
    node = tied(node);
    fixedNodes.erase(std::remove(fixedNodes.begin(), fixedNodes.end(), node), fixedNodes.end());
    for (size_t i = followNodes.size(); i-- > 0;)
        if (followNodes[i] == node) {
            followNodes.erase(followNodes.begin() + static_cast<long>(i));
            followIds.erase(followIds.begin() + static_cast<long>(i));
            followAt.erase(followAt.begin() + static_cast<long>(i));
        }
    for (size_t i = loadNodes.size(); i-- > 0;)
        if (loadNodes[i] == node) {
            loadNodes.erase(loadNodes.begin() + static_cast<long>(i));
            loads.erase(loads.begin() + static_cast<long>(i));
        }
    changed();
}

} // namespace yade
