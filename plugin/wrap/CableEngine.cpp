// SPDX-License-Identifier: GPL-2.0-or-later
#include "CableEngine.hpp"

#include "Drive.hpp"

#include <core/Clump.hpp>
#include <core/InteractionLoop.hpp>
#include <core/Omega.hpp>
#include <lib/pyutil/gil.hpp>
#include <pkg/dem/NewtonIntegrator.hpp>

extern "C" {
#include "ancf/balance.h"
#include "ancf/elastic.h"
#include "ancf/equilibrium.h"
#include "ancf/mass.h"
#include "ancf/stability.h"
}

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <sstream>

namespace yade {

YADE_PLUGIN((CableEngine))
CREATE_LOGGER(CableEngine);

namespace {
    constexpr long checkInterval = 100; // steps between two looks at the strain
    constexpr Real workingStrain = .05; // of a cable that presses on what it holds
    constexpr Real contactReserve = .9; // of the critical step of a contact
    constexpr Real strainReserve = .1;  // strain up to which automatic steps are stable

    template <class... Parts> string text(const Parts&... parts) {
        std::ostringstream out;
        (out << ... << parts);
        return out.str();
    }

    Vector3r vectorOf(const Real* p) { return Vector3r(p[0], p[1], p[2]); }

    Vector3r at(const ancf_model* m, const Real* field, int element, Real xi) {
        Real value[3];
        ancf_model_at(value, m, field, element, xi);
        return vectorOf(value);
    }

    Vector3r at(const ancf_model* m, const Real* field, const ancf_point& point) {
        Real value[3];
        ancf_point_at(value, m, field, &point);
        return vectorOf(value);
    }

    Vector3r ofNode(const ancf_model* m, const Real* field, int node) {
        return Vector3r(field[node], field[m->stride + node], field[2 * m->stride + node]);
    }

    void setNode(const ancf_model* m, Real* field, int node, const Vector3r& value) {
        for (int c = 0; c < 3; ++c) field[c * m->stride + node] = value[c];
    }

    void addNode(const ancf_model* m, Real* field, int node, const Vector3r& value) {
        for (int c = 0; c < 3; ++c) field[c * m->stride + node] += value[c];
    }

    Matrix3r skew(const Vector3r& v) {
        Matrix3r m;
        m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
        return m;
    }

    Quaternionr turn(const Vector3r& angle) {
        const Real size = angle.norm();
        return size > 0 ? Quaternionr(AngleAxisr(size, angle / size)) : Quaternionr::Identity();
    }

    // Forces on a body before NewtonIntegrator, a clump's members included.
    void forceOn(Scene& scene, const Body& body, Vector3r& force, Vector3r& torque) {
        force = scene.forces.getForce(body.id);
        torque = scene.forces.getTorque(body.id);
        if (!body.isClump()) return;
        for (const auto& member : static_cast<const Clump&>(*body.shape).members) {
            const Vector3r& f = scene.forces.getForce(member.first);
            force += f;
            torque += scene.forces.getTorque(member.first) +
                      ((*scene.bodies)[member.first]->state->pos - body.state->pos).cross(f);
        }
    }

    bool anyForces(Scene& scene) { return !scene.forces.synced || scene.forces.getPermForceUsed(); }

    template <class T> bool has(const vector<T>& values, const T& value) {
        return std::find(values.begin(), values.end(), value) != values.end();
    }
} // namespace

// ---------------------------------------------------------------- what it is made of

Scene& CableEngine::theScene() const { return scene ? *scene : *Omega::instance().getScene(); }

void CableEngine::refuse(const string& why) const { throw std::runtime_error(text("CableEngine ", family, ": ", why)); }

const CableEngine* CableEngine::find(const Scene& scene, int family) {
    for (const auto& engine : scene.engines)
        if (const auto* cables = dynamic_cast<const CableEngine*>(engine.get()); cables && cables->family == family)
            return cables;
    return nullptr;
}

bool CableEngine::adjacent(int e1, int e2) const {
    const int *a = &ends[2 * e1], *b = &ends[2 * e2];
    return e1 == e2 || a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1];
}

void CableEngine::changed() {
    model.reset();
    pairsChecked = false;
    trackedIter = -2;
}

void CableEngine::checkNode(int node, const char* what) const {
    if (node < 0 || node >= nNodes)
        throw std::out_of_range(text("CableEngine.", what, ": node ", node, " does not exist, there are ", nNodes));
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

py::tuple CableEngine::add(const vector<Vector3r>& nodes, const vector<Vector3r>& slopes, const vector<int>& newEnds,
                           const vector<int>& newNext, int newKind, const vector<Real>& newLength, Real newEa,
                           Real newEi, Real newRhoA, Real newDamping) {
    const int firstNode = nNodes, firstElement = nElements(), n = static_cast<int>(nodes.size()),
              e = static_cast<int>(newLength.size());
    if (n < 2 || e < 1 || slopes.size() != 2 * newLength.size() || newEnds.size() != slopes.size() ||
        newNext.size() != newLength.size())
        throw std::invalid_argument(text("CableEngine.add: ", n, " nodes and ", e, " lengths need ", 2 * e,
                                         " slopes and ends and ", e, " next; got ", slopes.size(), ", ", newEnds.size(),
                                         " and ", newNext.size()));
    vector<ancf_element> elements;
    for (const Real l : newLength) elements.push_back({newKind, l, newEa, newEi, newRhoA, newDamping});

    const int allNodes = nNodes + n, all = firstElement + e, stride = ancf_stride(allNodes, all);
    vector<Real> x = widen(position, nNodes, firstElement, allNodes, all),
                 v = widen(velocity, nNodes, firstElement, allNodes, all);
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < n; ++i) x[c * stride + firstNode + i] = nodes[i][c];
        for (int i = 0; i < e; ++i) {
            x[c * stride + allNodes + firstElement + i] = slopes[2 * i][c];
            x[c * stride + allNodes + all + firstElement + i] = slopes[2 * i + 1][c];
        }
    }
    // The new part alone, to refuse it before it is in.
    const ancf_def def = {n, e, elements.data(), newEnds.data(), newNext.data(), nullptr, nullptr};
    vector<Real> newX(3 * static_cast<size_t>(ancf_stride(n, e)), 0), newV = newX;
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < n; ++i) newX[c * ancf_stride(n, e) + i] = nodes[i][c];
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < e; ++i) newX[c * ancf_stride(n, e) + n + i] = slopes[2 * i].sum() + slopes[2 * i + 1].sum();
    ancf_model* trial = nullptr;
    int where = 0;
    const ancf_error error = ancf_model_create(&trial, &def, newX.data(), newV.data(), &where);
    ancf_model_destroy(trial);
    if (error)
        throw std::invalid_argument(text("CableEngine.add: element or node ", where, ": ", ancf_error_text(error)));

    position = std::move(x);
    velocity = std::move(v);
    for (const int k : newEnds) ends.push_back(firstNode + k);
    for (const int k : newNext) next.push_back(k < 0 ? -1 : firstElement + k);
    kind.insert(kind.end(), e, newKind);
    length.insert(length.end(), newLength.begin(), newLength.end());
    ea.insert(ea.end(), e, newEa);
    ei.insert(ei.end(), e, newEi);
    rhoA.insert(rhoA.end(), e, newRhoA);
    kelvinVoigt.insert(kelvinVoigt.end(), e, newDamping);
    nNodes = allNodes;
    changed();
    return py::make_tuple(firstNode, firstElement);
}

void CableEngine::addPoint(Body::id_t id, int element, Real xi) {
    if (element < 0 || element >= nElements() || !(xi >= 0 && xi <= 1))
        throw std::invalid_argument(
            text("CableEngine.addPoint: element ", element, " of ", nElements(), ", xi = ", xi, ": xi must be 0 to 1"));
    Scene& s = theScene();
    if (!s.bodies->exists(id) || !CablePoint::of(*(*s.bodies)[id]))
        throw std::invalid_argument(
            text("CableEngine.addPoint: body ", id, " must exist and have the shape CablePoint"));
    pointIds.push_back(id);
    pointElement.push_back(element);
    pointXi.push_back(xi);
    changed();
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

namespace {
    const Body& bodyOf(const Scene& s, Body::id_t id, const char* what) {
        if (!s.bodies->exists(id))
            throw std::invalid_argument(text("CableEngine.", what, ": body ", id, " does not exist"));
        return *(*s.bodies)[id];
    }

    Vector3r nodePosition(const vector<Real>& field, int stride, int node) {
        return Vector3r(field[node], field[stride + node], field[2 * stride + node]);
    }
} // namespace

void CableEngine::follow(int node, Body::id_t id) {
    checkNode(node, "follow");
    checkUnclaimed(node = tied(node));
    const Body& body = bodyOf(theScene(), id, "follow");
    if (movedBody(theScene(), body).isDynamic() && movedBody(theScene(), body).state->blockedDOFs != State::DOF_ALL)
        throw std::invalid_argument(
            text("CableEngine.follow: body ", id, " moves freely and would not feel the cable: use carry"));
    followNodes.push_back(node);
    followIds.push_back(id);
    followAt.push_back(body.state->ori.conjugate() * (nodePosition(position, getStride(), node) - body.state->pos));
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
    const Real gap = (state.pos + state.ori * place - nodePosition(position, getStride(), node)).norm();
    if (gap > 1e-6 * (1 + state.pos.norm()))
        throw std::invalid_argument(text("CableEngine.carry: node ", node, " is ", gap,
                                         " m from the point `at` of body ", id, ": put the body there first"));
    // Free to move and held at its centre, the body is no more than mass at the node.
    if (place.norm() == 0 && !(state.blockedDOFs & State::DOF_XYZ)) {
        if (has(carryIds, id))
            throw std::invalid_argument(text("CableEngine.carry: body ", id, " is carried at its centre already"));
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
    for (size_t i = 0; i < tiedNodes.size(); ++i)
        if (tiedNodes[i] == node) return tied(tiedTo[i]);
    return node;
}

void CableEngine::tie(int node, int other) {
    checkNode(node, "tie");
    checkNode(other, "tie");
    node = tied(node);
    other = tied(other);
    if (node == other) throw std::invalid_argument(text("CableEngine.tie: node ", node, " with itself"));
    checkUnclaimed(other);
    const Real gap = (nodePosition(position, getStride(), node) - nodePosition(position, getStride(), other)).norm();
    if (gap > 1e-6 * (1 + nodePosition(position, getStride(), node).norm()))
        throw std::invalid_argument(
            text("CableEngine.tie: nodes ", node, " and ", other, " are ", gap, " m apart: they must be at one place"));
    for (int& end : ends)
        if (end == other) end = node;
    for (int& loaded : loadNodes)
        if (loaded == other) loaded = node;
    tiedNodes.push_back(other);
    tiedTo.push_back(node);
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

// ---------------------------------------------------------------- getting ready

namespace {
    bool centred(const Scene& s, const Body& body, const Vector3r& place) {
        return place.norm() == 0 && (body.state->blockedDOFs & State::DOF_XYZ) == State::DOF_XYZ &&
               !placedByDrive(s, body);
    }
} // namespace

void CableEngine::makeModel() {
    const size_t n = static_cast<size_t>(nNodes), e = length.size(), size = 3 * static_cast<size_t>(getStride());
    if (kind.size() != e || ea.size() != e || ei.size() != e || rhoA.size() != e || kelvinVoigt.size() != e)
        refuse(text("kind, length, ea, ei, rhoA and kelvinVoigt must have one length, ", next.size()));
    if (position.size() != size || velocity.size() != size)
        refuse(text("position and velocity must have ", size, " entries, 3 blocks of stride"));
    vector<ancf_element> elements;
    for (size_t i = 0; i < e; ++i) elements.push_back({kind[i], length[i], ea[i], ei[i], rhoA[i], kelvinVoigt[i]});
    vector<Real> mass(n, 0);
    for (size_t i = 0; i < carryNodes.size(); ++i) {
        const Body& body = bodyOf(theScene(), carryIds[i], "carry");
        if (centred(theScene(), body, carryAt[i])) mass[carryNodes[i]] += body.state->mass;
    }
    vector<int> hold(n + 2 * e, ANCF_FREE);
    for (const int node : fixedNodes) hold[node] = ANCF_HELD;
    for (const int node : followNodes) hold[node] = ANCF_HELD;
    for (const int node : tiedNodes) hold[node] = ANCF_HELD; // nothing is fastened to them any more
    for (const int end : clampedEnds) hold[n + (end % 2) * e + end / 2] = ANCF_HELD;
    const ancf_def def = {nNodes, nElements(), elements.data(), ends.data(), next.data(), mass.data(), hold.data()};
    ancf_model* made = nullptr;
    int where = 0;
    const ancf_error error = ancf_model_create(&made, &def, position.data(), velocity.data(), &where);
    if (error) refuse(text("element or node ", where, ": ", ancf_error_text(error)));
    model.reset(made);
}

// How the cable answers at contact points, carriers and couplings.
void CableEngine::makeResponses() {
    struct Place {
        ancf_point* point;
        size_t offset;
    };
    vector<Place> places;
    const int size = ancf_mass_response_size(model.get());
    vector<int> dof(size);
    vector<Real> value(size);
    responseDof.clear();
    responseValue.clear();
    const auto make = [&](ancf_point& p, int element, Real xi) {
        ancf_point_place(&p, model.get(), element, xi);
        p.n = ancf_mass_response(model.get(), dof.data(), value.data(), &p.compliance, element, xi);
        places.push_back({&p, responseDof.size()});
        responseDof.insert(responseDof.end(), dof.begin(), dof.begin() + p.n);
        responseValue.insert(responseValue.end(), value.begin(), value.begin() + p.n);
    };
    const auto makeAtNode = [&](ancf_point& p, int node) {
        const int end = model->at[model->first[node]];
        make(p, end >> 1, end & 1);
    };
    points.resize(pointIds.size());
    for (size_t i = 0; i < points.size(); ++i) make(points[i], pointElement[i], pointXi[i]);
    carriers.resize(carryNodes.size());
    for (size_t i = 0; i < carriers.size(); ++i) makeAtNode(carriers[i], carryNodes[i]);
    for (Coupling& c : couplings) makeAtNode(c.point, c.node);
    for (const Place& p : places) {
        p.point->dof = responseDof.data() + p.offset;
        p.point->dv = responseValue.data() + p.offset;
    }
}

// Contact points that feel each other: those of one element and of elements that meet it, with the velocity that a unit
// impulse at one gives to the other. They stiffen a cable together, and so limit the step together.
void CableEngine::makeNeighbours() {
    vector<vector<int>> onElement(length.size());
    for (size_t i = 0; i < points.size(); ++i) onElement[points[i].element].push_back(static_cast<int>(i));
    vector<Real> response(position.size(), 0);
    firstNeighbour.assign(1, 0);
    neighbour.clear();
    neighbourCompliance.clear();
    for (const ancf_point& p : points) {
        std::set<int> elements;
        for (const int node : {p.place[0], p.place[2]})
            for (int k = model->first[node]; k < model->first[node + 1]; ++k) elements.insert(model->at[k] >> 1);
        for (int k = 0; k < p.n; ++k) response[p.dof[k]] = p.dv[k];
        for (const int e : elements)
            for (const int j : onElement[e]) {
                neighbour.push_back(j);
                neighbourCompliance.push_back(std::abs(at(model.get(), response.data(), points[j])[0]));
            }
        for (int k = 0; k < p.n; ++k) response[p.dof[k]] = 0;
        firstNeighbour.push_back(static_cast<int>(neighbour.size()));
    }
    stiffness.assign(points.size(), 0);
}

// The contacts as they stand allow a step of 2/sqrt of the largest row sum of stiffness over mass.
void CableEngine::checkContacts() {
    if (rows.empty()) return;
    const auto eachEnd = [&](size_t row, const auto& f) {
        for (const ancf_point* p : {table[row].point, table[row].other})
            if (p && p >= points.data() && p < points.data() + points.size()) f(p - points.data());
    };
    for (size_t i = 0; i < rows.size(); ++i) eachEnd(i, [&](long point) { stiffness[point] += rows[i].phys->kn; });
    for (size_t i = 0; i < rows.size(); ++i) {
        Real sum = 0;
        eachEnd(i, [&](long point) {
            for (int k = firstNeighbour[point]; k < firstNeighbour[point + 1]; ++k)
                sum += stiffness[neighbour[k]] * neighbourCompliance[k];
        });
        if (sum * scene->dt * scene->dt > 4)
            refuse(text("at iteration ", scene->iter, " the contact of point ", rows[i].cable, " with body ",
                        rows[i].other, " is too stiff for O.dt = ", scene->dt,
                        " s: use O.dt <= ", contactReserve * 2 / std::sqrt(sum)));
    }
    for (size_t i = 0; i < rows.size(); ++i) eachEnd(i, [&](long point) { stiffness[point] = 0; });
}

// Which bodies are contact points, or are carried at their centres.
void CableEngine::mapBodies() {
    const Scene& s = theScene();
    carrierOfBody.assign(s.bodies->size(), -1);
    pointOfBody.assign(s.bodies->size(), -1);
    for (size_t i = 0; i < carryNodes.size(); ++i)
        if (centred(s, bodyOf(s, carryIds[i], "carry"), carryAt[i])) carrierOfBody[carryIds[i]] = static_cast<int>(i);
    for (size_t i = 0; i < pointIds.size(); ++i) {
        if (!s.bodies->exists(pointIds[i])) refuseErased(pointIds[i]);
        pointOfBody[pointIds[i]] = static_cast<int>(i);
    }
}

void CableEngine::makeCouplings() {
    couplings.clear();
    for (size_t i = 0; i < carryNodes.size(); ++i) {
        if (carrierOfBody[carryIds[i]] >= 0) continue;
        Coupling c {};
        c.node = carryNodes[i];
        c.id = carryIds[i];
        c.at = carryAt[i];
        couplings.push_back(c);
    }
}

void CableEngine::refuseErased(Body::id_t id) const {
    refuse(text("contact point ", id, " was erased: erase the whole cable, or make one without contact points"));
}

// Pairs of bodies without functors, which YADE does not tell: the package's own check, in Python.
void CableEngine::checkPairs() const {
    gilLock lock;
    try {
        py::import("ancf.scene").attr("check")();
    } catch (const py::error_already_set&) {
        PyObject *type, *value, *trace;
        PyErr_Fetch(&type, &value, &trace);
        PyErr_NormalizeException(&type, &value, &trace);
        const py::handle<> held(value);
        Py_XDECREF(type);
        Py_XDECREF(trace);
        throw std::runtime_error(py::extract<string>(py::str(py::object(held)))());
    }
}

void CableEngine::checkScene() const {
    const Scene& s = theScene();
    if (s.isPeriodic) refuse("a periodic cell is not supported: set O.periodic = False");
    if (integrator != "leapfrog" && integrator != "rk4")
        refuse(text("integrator = '", integrator, "': must be 'leapfrog' or 'rk4'"));
    if (substeps < 0) refuse(text("substeps = ", substeps, ": must be 0 (automatic) or more"));
    bool seen = false, moved = false;
    for (const auto& engine : s.engines) {
        if (engine.get() == this) {
            seen = true;
            if (moved) refuse("stands after NewtonIntegrator in O.engines: must stand before it");
        }
        if (dynamic_cast<const NewtonIntegrator*>(engine.get())) moved = true;
        if (seen && dynamic_cast<const InteractionLoop*>(engine.get()))
            refuse("stands before InteractionLoop in O.engines: must stand after it");
    }
}

void CableEngine::build() {
    checkScene();
    makeModel();
    mapBodies();
    makeCouplings();
    if (!couplings.empty() && substeps > 1)
        refuse(text("substeps = ", substeps, ": body ", couplings[0].id,
                    " is carried off its centre or guided, which needs substeps = 1 or 0"));
    makeResponses();
    makeNeighbours();
    const size_t size = position.size();
    contactForce.assign(size, 0);
    after.assign(size, 0);
    pointMotion.assign(6 * points.size(), 0);
    carriedForce.assign(carryNodes.size(), Vector3r::Zero());
    carryReaction.resize(carryNodes.size(), Vector3r::Zero());
    checkedIter = -1;
    int element;
    substepLimit = ancf_critical_step(model.get(), strainReserve, &element);
}

ancf_time CableEngine::timeOfStep() const {
    ancf_time t {theScene().dt, lastStep, std::max(1, substeps), lastSubstep};
    if (integrator == "rk4") {
        t = {t.step, t.step, 1, t.step};
    } else if (substeps == 0 && couplings.empty()) {
        t.substeps = std::max(1, static_cast<int>(std::ceil(t.step / substepLimit)));
    }
    return t;
}

// At the first step, when O.dt changes, and every checkInterval steps: is the step stable, the state finite?
void CableEngine::checkStep() {
    const Scene& s = theScene();
    if (s.dt == checkedStep && checkedIter >= 0 && s.iter < checkedIter + checkInterval) return;
    if (!(s.dt > 0) || !std::isfinite(s.dt)) refuse(text("O.dt = ", s.dt, ": must be above 0"));
    int strained = 0, stiffest = 0;
    const Real largest = ancf_strain_max(model.get(), model->x, &strained);
    for (const Real value : position)
        if (!std::isfinite(value))
            refuse(text("the state is no longer finite at iteration ", s.iter, " (element ", strained,
                        "): the step was too long, or a force not finite"));
    const Real limit = ancf_critical_step(model.get(), largest, &stiffest), step = time.step / time.substeps;
    if (integrator == "leapfrog" && step > 1.0000001 * limit)
        refuse(text("at iteration ", s.iter, " the step of the cable ", step, " s is above the critical ", limit,
                    " s of element ", stiffest, " (largest strain ", largest, " in element ", strained,
                    "): use O.dt <= ", limit * time.substeps, " or more substeps"));
    checkedIter = s.iter;
    checkedStep = s.dt;
}

// ---------------------------------------------------------------- one step

// New velocities of nodes that follow a body, exactly to where NewtonIntegrator will take it.
void CableEngine::holdNodes() {
    for (size_t i = 0; i < followNodes.size(); ++i) {
        const State& state = *(*scene->bodies)[followIds[i]]->state;
        const Vector3r target =
            state.pos + scene->dt * state.vel + turn(scene->dt * state.angVel) * (state.ori * followAt[i]);
        setNode(model.get(), model->held, followNodes[i],
                (target - ofNode(model.get(), model->x, followNodes[i])) / scene->dt);
    }
    for (const Coupling& c : couplings) {
        const State& state = *(*scene->bodies)[c.id]->state;
        setNode(model.get(), model->x, c.node, state.pos + state.ori * c.at);
    }
}

// Loads on nodes, and what acts on carried bodies and on contact points by others' engines and laws.
void CableEngine::gatherForces() {
    std::fill_n(model->external, position.size(), 0);
    std::fill(contactForce.begin(), contactForce.end(), 0);
    for (size_t i = 0; i < loadNodes.size(); ++i) addNode(model.get(), model->external, loadNodes[i], loads[i]);
    pushed = anyForces(*scene);
    if (!pushed) {
        std::fill(carriedForce.begin(), carriedForce.end(), Vector3r::Zero());
        return;
    }
    scene->forces.sync();
    for (size_t i = 0; i < carryNodes.size(); ++i) {
        Vector3r torque;
        forceOn(*scene, *(*scene->bodies)[carryIds[i]], carriedForce[i], torque);
        if (carrierOfBody[carryIds[i]] >= 0) addNode(model.get(), contactForce.data(), carryNodes[i], carriedForce[i]);
    }
    for (size_t i = 0; i < points.size(); ++i) {
        const Vector3r& force = scene->forces.getForce(pointIds[i]);
        if (force != Vector3r::Zero()) ancf_point_add_force(model.get(), contactForce.data(), &points[i], force.data());
    }
}

// The body as it will move without the cable's forces; number in `partners`.
int CableEngine::partnerOf(const Body& touched) {
    const Body& body = movedBody(*scene, touched);
    for (size_t i = 0; i < partners.size(); ++i)
        if (partners[i].id == body.id) return static_cast<int>(i);
    const State& state = *body.state;
    const Mobility m = mobility(*scene, body);
    Vector3r vel = state.vel, spin = state.angVel, force, torque;
    if (m.movable()) {
        scene->forces.sync();
        forceOn(*scene, body, force, torque);
    }
    if (drivenBody(*scene, body)) {
        eachDrive(*scene, [&](const Drive& drive) { drive.predict(vel, spin, *scene, body, force, torque); });
    } else if (m.movable()) {
        for (int c = 0; c < 3; ++c)
            if (m.inverseMass[c] > 0) vel[c] += scene->dt * (m.inverseMass[c] * force[c] + gravity[c]);
        if (body.isAspherical()) {
            const Vector3r local = state.ori.conjugate() * state.angVel;
            torque -= state.angVel.cross(state.ori * state.inertia.cwiseProduct(local));
        }
        spin += scene->dt * (m.inverseInertia * torque);
    }
    Partner p;
    p.id = body.id;
    for (int c = 0; c < 3; ++c) {
        p.body.position[c] = state.pos[c];
        p.body.velocity[c] = vel[c];
        p.body.spin[c] = spin[c];
        p.body.inv_mass[c] = m.inverseMass[c];
        p.body.along[c] = m.along[c];
        for (int d = 0; d < 3; ++d) p.body.inv_inertia[3 * c + d] = m.inverseInertia(c, d);
    }
    if (carrierOfBody[body.id] >= 0) // its velocity is that of its knot, which is `other` in the row
        for (int c = 0; c < 3; ++c) p.body.velocity[c] = 0;
    partners.push_back(p);
    return static_cast<int>(partners.size()) - 1;
}

void CableEngine::gatherContact(const Interaction& contact) {
    auto* phys = dynamic_cast<HollarsPhys*>(contact.phys.get());
    if (!phys || phys->normalForce == Vector3r::Zero()) return;
    const int first = pointOfBody[contact.getId1()], second = pointOfBody[contact.getId2()];
    const bool swapped = first < 0; // the cable is the second body
    const Body& touched = *(*scene->bodies)[swapped ? contact.getId1() : contact.getId2()];
    Row row {phys,
             swapped ? contact.getId2() : contact.getId1(),
             touched.id,
             -1,
             swapped ? phys->normalForce : Vector3r(-phys->normalForce),
             phys->frictionLaw()};
    ancf_contact c {};
    c.point = &points[swapped ? second : first];
    if (!swapped && second >= 0) {
        c.other = &points[second];
    } else {
        if (CablePoint::of(touched))
            refuse(text("its contact point ", row.cable, " touches point ", touched.id,
                        " of another engine: append both cables to one engine"));
        row.partner = partnerOf(touched);
        const int carrier = carrierOfBody[movedBody(*scene, touched).id];
        if (carrier >= 0) c.other = &carriers[carrier];
    }
    c.normal_force = row.normalForce.norm();
    for (int i = 0; i < 3; ++i) {
        c.normal[i] = row.normalForce[i] / c.normal_force;
        c.friction[i] = swapped ? phys->shearForce[i] : -phys->shearForce[i];
    }
    const Real depth = static_cast<const ScGeom&>(*contact.geom).penetrationDepth;
    maxPenetration = std::max(maxPenetration, depth);
    c.normal_damping = phys->damping(depth);
    c.damping_force = phys->dampingForce;
    rows.push_back(row);
    table.push_back(c);
}

// The table of contacts, in the order of body ids: the same sums whatever the number of threads.
void CableEngine::gatherContacts() {
    table.clear();
    rows.clear();
    partners.clear();
    for (const Coupling& c : couplings) partnerOf(*(*scene->bodies)[c.id]);
    vector<const Interaction*> touching;
    const int known = static_cast<int>(pointOfBody.size());
    for (const auto& contact : *scene->interactions)
        if (contact->isReal() && contact->getId1() < known && contact->getId2() < known &&
            (pointOfBody[contact->getId1()] >= 0 || pointOfBody[contact->getId2()] >= 0))
            touching.push_back(contact.get());
    std::sort(touching.begin(), touching.end(), [](const Interaction* a, const Interaction* b) {
        return std::minmax(a->getId1(), a->getId2()) < std::minmax(b->getId1(), b->getId2());
    });
    for (const Interaction* contact : touching) gatherContact(*contact);
    contacts = static_cast<int>(rows.size());
    for (size_t i = 0; i < rows.size(); ++i) { // only now do pointers into the tables last
        table[i].law = &rows[i].law;
        const Real* f = rows[i].normalForce.data();
        const Vector3r back = -rows[i].normalForce;
        ancf_point_add_force(model.get(), contactForce.data(), table[i].point, f);
        if (table[i].other) ancf_point_add_force(model.get(), contactForce.data(), table[i].other, back.data());
        if (rows[i].partner < 0) continue;
        ancf_partner& p = partners[rows[i].partner].body;
        table[i].partner = &p;
        const Vector3r arm = (*scene->bodies)[rows[i].cable]->state->pos - vectorOf(p.position);
        const Vector3r moment = ancf_kick(&time) * arm.cross(back);
        const Real guided = ancf_kick(&time) * vectorOf(p.along).dot(back);
        for (int c = 0; c < 3; ++c) {
            p.velocity[c] += ancf_kick(&time) * p.inv_mass[c] * back[c] + guided * p.along[c];
            for (int d = 0; d < 3; ++d) p.spin[c] += p.inv_inertia[3 * c + d] * moment[d];
        }
    }
    ancf_model_join(model.get(), contactForce.data());
    checkContacts();
}

void CableEngine::solveFriction() {
    if (table.empty()) return;
    sweeps =
        ancf_contact_solve(model.get(), table.data(), static_cast<int>(table.size()), ancf_kick(&time), after.data());
}

// The impulses that make each coupled knot and its body's point go on together (Eq. 5, multipliers solved for).
void CableEngine::solveCouplings() {
    const int n = static_cast<int>(couplings.size());
    if (n == 0) return;
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    Eigen::VectorXd gap(3 * n);
    vector<Vector3r> arm(n);
    vector<int> partner(n);
    for (int i = 0; i < n; ++i) {
        const Body& body = *(*scene->bodies)[couplings[i].id];
        arm[i] = body.state->ori * couplings[i].at;
        partner[i] = partnerOf(body);
        const ancf_partner& p = partners[partner[i]].body;
        const Vector3r spin = vectorOf(p.spin);
        const Vector3r target =
            vectorOf(p.velocity) + spin.cross(arm[i]) + .5 * scene->dt * spin.cross(spin.cross(arm[i]));
        gap.segment<3>(3 * i) = target - ofNode(model.get(), after.data(), couplings[i].node);
    }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            auto block = A.block<3, 3>(3 * i, 3 * j);
            const ancf_point& p = couplings[j].point;
            for (int k = 0; k < p.n; ++k)
                if (p.dof[k] == couplings[i].node) block += p.dv[k] * Matrix3r::Identity();
            if (partner[i] != partner[j]) continue;
            const Mobility m = mobility(*scene, *(*scene->bodies)[couplings[i].id]);
            block += m.massPart() - skew(arm[i]) * m.inverseInertia * skew(arm[j]);
        }
    const Eigen::VectorXd impulse = A.ldlt().solve(gap);
    for (int i = 0; i < n; ++i) {
        const Vector3r P = impulse.segment<3>(3 * i), moment = arm[i].cross(P);
        const ancf_point& point = couplings[i].point;
        for (int k = 0; k < point.n; ++k)
            for (int c = 0; c < 3; ++c) after[c * model->stride + point.dof[k]] += point.dv[k] * P[c];
        ancf_partner& p = partners[partner[i]].body;
        const Real guided = vectorOf(p.along).dot(P);
        for (int c = 0; c < 3; ++c) {
            p.velocity[c] -= p.inv_mass[c] * P[c] + guided * p.along[c];
            for (int d = 0; d < 3; ++d) p.spin[c] -= p.inv_inertia[3 * c + d] * moment[d];
        }
        couplings[i].impulse += P;
    }
}

// Forces on what the cables touch and carry.
void CableEngine::react() {
    const Real scale = ancf_kick(&time) / time.step; // the first kick is half as long for cables as for bodies
    for (size_t i = 0; i < rows.size(); ++i) {
        const ancf_contact& c = table[i];
        const Vector3r friction = vectorOf(c.friction), damped = c.damping_force * vectorOf(c.normal);
        const Vector3r normal = rows[i].normalForce + damped, late = damped + friction;
        const Vector3r total = scale * (normal + friction);
        const Real sign =
            rows[i].phys->normalForce.dot(rows[i].normalForce) > 0 ? 1 : -1; // the cable is second or first
        const Body& cable = *(*scene->bodies)[rows[i].cable];
        rows[i].phys->shearForce = sign * friction;
        rows[i].phys->normalForce = sign * normal;
        rows[i].phys->dampingForce = c.damping_force;
        ancf_add_contact(model.get(), &time, c.point, late.data());
        if (time.substeps > 1) ancf_add_contact(model.get(), &time, c.point, rows[i].normalForce.data());
        if (!c.partner) continue;
        const Body& body = *(*scene->bodies)[rows[i].other];
        if (!c.other) scene->forces.addForce(body.id, -total);
        scene->forces.addTorque(body.id, (cable.state->pos - body.state->pos).cross(-total));
    }
    for (const Coupling& c : couplings) {
        const State& state = *(*scene->bodies)[c.id]->state;
        const Vector3r force = -c.impulse / time.step;
        scene->forces.addForce(c.id, force);
        scene->forces.addTorque(c.id, (state.ori * c.at).cross(force));
    }
    size_t k = 0;
    for (size_t i = 0; i < carryNodes.size(); ++i) {
        if (carrierOfBody[carryIds[i]] < 0) {
            carryReaction[i] = couplings[k++].impulse / ancf_kick(&time);
            continue;
        }
        const Real mass = (*scene->bodies)[carryIds[i]]->state->mass;
        Vector3r touched = Vector3r::Zero();
        for (size_t r = 0; r < rows.size(); ++r)
            if (table[r].other == &carriers[i])
                touched -= rows[r].normalForce + table[r].damping_force * vectorOf(table[r].normal) +
                           vectorOf(table[r].friction);
        carryReaction[i] = carriedForce[i] + touched + mass * (gravity - ofNode(model.get(), model->a, carryNodes[i]));
    }
}

// Contact points and carried bodies go where NewtonIntegrator will find them at the new positions.
void CableEngine::scatter() {
    const Real dt = scene->dt;
    Real *x = pointMotion.data(), *v = x + 3 * points.size();
    ancf_points_motion(x, v, model.get(), points.data(), static_cast<int>(points.size()));
    for (size_t i = 0; i < points.size(); ++i, x += 3, v += 3) {
        const auto& body = (*scene->bodies)[pointIds[i]];
        if (!body) refuseErased(pointIds[i]);
        body->state->vel = vectorOf(v);
        body->state->pos = vectorOf(x) - dt * vectorOf(v);
    }
    for (size_t i = 0; i < carryNodes.size(); ++i) {
        if (carrierOfBody[carryIds[i]] < 0) continue;
        const auto& body = (*scene->bodies)[carryIds[i]];
        if (!body)
            refuse(text("body ", carryIds[i], ", carried by node ", carryNodes[i],
                        ", was erased: release the node first"));
        body->state->vel = ofNode(model.get(), model->v, carryNodes[i]);
        body->state->pos = ofNode(model.get(), model->x, carryNodes[i]) - dt * body->state->vel;
    }
}

// Energies at the half step, where the velocities are. Friction of cables belongs here, their normal forces to Law2.
void CableEngine::trackEnergy() {
    ancf_energy now;
    ancf_energy_of(&now, model.get(), 0, nElements());
    auto& tracker = *scene->energy;
    tracker.add(now.kinetic, "cableKinetic", kineticIx, true);
    const Real elastic = now.axial + now.bending, back = .5 / time.substeps; // velocities are half a sub-step old
    tracker.add(elastic + back * (lastElastic - elastic), "cableElastic", elasticIx, true);
    lastElastic = elastic;
    trackedIter = scene->iter;
    Real lifted = 0;
    if (gravity != Vector3r::Zero()) {
        for (int c = 0; c < 3; ++c) // without carried masses, which NewtonIntegrator counts
            for (int i = 0; i < model->n_dof; ++i) {
                const Real moved = time.step * model->v[c * model->stride + i];
                const bool copy = i >= nNodes + nElements() && next[i - nNodes - nElements()] >= 0;
                if (!copy) lifted -= gravity[c] * model->weight[i] * moved;
            }
        for (size_t i = 0; i < carryNodes.size(); ++i)
            if (carrierOfBody[carryIds[i]] >= 0)
                lifted += time.step * (*scene->bodies)[carryIds[i]]->state->mass *
                          gravity.dot(ofNode(model.get(), model->v, carryNodes[i]));
    }
    tracker.add(lifted, "gravWork", gravityIx, false);
    tracker.add(model->damping_work, "cableDamping", dampingIx, false);
    Real rubbed = 0, damped = 0;
    for (const ancf_contact& c : table) {
        Vector3r slip = at(model.get(), model->v, *c.point);
        if (c.other) slip -= at(model.get(), model->v, *c.other);
        if (c.partner) {
            const Vector3r arm = at(model.get(), model->x, *c.point) - vectorOf(c.partner->position);
            slip -= vectorOf(c.partner->velocity) + vectorOf(c.partner->spin).cross(arm);
        }
        rubbed -= vectorOf(c.friction).dot(slip);
        damped -= c.damping_force * vectorOf(c.normal).dot(slip);
    }
    tracker.add(rubbed * time.step, "cableFriction", frictionIx, false);
    tracker.add(damped * time.step, "contactDamping", contactIx, false);
}

void CableEngine::action() {
    if (!model || !pairsChecked) build(); // engines that drive bodies may have come since
    if (!pairsChecked) checkPairs();
    pairsChecked = true;
    if (pointOfBody.size() != scene->bodies->size()) mapBodies();
    model->x = position.data();
    model->v = velocity.data();
    model->track = scene->trackEnergy;
    time = timeOfStep();
    checkStep();
    for (const auto& engine : scene->engines)
        if (const auto* newton = dynamic_cast<const NewtonIntegrator*>(engine.get())) gravity = newton->gravity;
    for (int c = 0; c < 3; ++c) model->gravity[c] = gravity[c];
    for (Coupling& c : couplings) c.impulse = Vector3r::Zero();

    eachDrive(*scene, [&](Drive& drive) { drive.prepare(*scene); });
    holdNodes();
    gatherForces();
    gatherContacts();
    ancf_predict(model.get(), &time, rows.empty() && !pushed ? nullptr : contactForce.data());
    std::copy_n(model->free, after.size(), after.begin());
    solveCouplings();
    solveFriction();
    if (!rows.empty()) solveCouplings();
    if (scene->trackEnergy) {
        if (trackedIter != scene->iter - 1) { // else known from the step before
            Real axial, bending;
            ancf_elastic_energy(&axial, &bending, model.get(), model->x, 0, nElements());
            lastElastic = axial + bending;
        }
        model->damping_work = 0;
    }
    if (integrator == "rk4") {
        for (size_t i = 0; i < after.size(); ++i) model->external[i] += contactForce[i];
        for (const ancf_contact& c : table) {
            const Vector3r late = vectorOf(c.friction) + c.damping_force * vectorOf(c.normal);
            ancf_point_add_force(model.get(), model->external, c.point, late.data());
        }
        ancf_rk4(model.get(), time.step);
    } else {
        ancf_correct(model.get(), &time, after.data());
    }
    react();
    scatter();
    lastStep = time.step;
    lastSubstep = time.step / time.substeps;
    if (scene->trackEnergy) trackEnergy();
}

// ---------------------------------------------------------------- what it tells

namespace {
    void checkPlace(int element, Real xi, int n) {
        if (element < 0 || element >= n)
            throw std::out_of_range(text("CableEngine: element ", element, " does not exist, there are ", n));
        if (!(xi >= 0 && xi <= 1))
            throw std::invalid_argument(text("CableEngine: xi = ", xi, " on element ", element, ": must be 0 to 1"));
    }
} // namespace

Vector3r CableEngine::point(int element, Real xi) {
    checkPlace(element, xi, nElements());
    if (!model) build();
    return at(model.get(), position.data(), element, xi);
}

Vector3r CableEngine::pointVelocity(int element, Real xi) {
    checkPlace(element, xi, nElements());
    if (!model) build();
    return at(model.get(), velocity.data(), element, xi);
}

Real CableEngine::tension(int element, Real xi) {
    checkPlace(element, xi, nElements());
    if (!model) build();
    model->x = position.data();
    model->v = velocity.data();
    return ancf_tension(model.get(), element, xi);
}

Real CableEngine::strain(int element, Real xi) {
    checkPlace(element, xi, nElements());
    if (!model) build();
    return ancf_strain(model.get(), position.data(), element, xi);
}

Vector3r CableEngine::reaction(int node) {
    checkNode(node, "reaction");
    node = tied(node);
    if (!model) build();
    for (size_t i = 0; i < carryNodes.size(); ++i)
        if (carryNodes[i] == node) return carryReaction[i];
    if (!has(fixedNodes, node) && !has(followNodes, node))
        throw std::invalid_argument(text("CableEngine.reaction: node ", node, " is free: nothing holds it"));
    Real force[3];
    ancf_reaction(force, model.get(), node);
    return vectorOf(force);
}

py::dict CableEngine::energy(int first, int last) {
    if (first < 0 || last > nElements() || first > last)
        throw std::out_of_range(
            text("CableEngine.energy: elements ", first, " to ", last, ": there are ", nElements()));
    if (!model) build();
    model->x = position.data();
    model->v = velocity.data();
    for (int c = 0; c < 3; ++c) model->gravity[c] = gravity[c];
    ancf_energy e;
    ancf_energy_of(&e, model.get(), first, last);
    py::dict all;
    all["kinetic"] = e.kinetic;
    all["axial"] = e.axial;
    all["bending"] = e.bending;
    all["gravity"] = e.gravity;
    return all;
}

py::tuple CableEngine::momentum() {
    if (!model) build();
    model->x = position.data();
    model->v = velocity.data();
    Real linear[3], angular[3];
    ancf_momentum(linear, angular, model.get());
    return py::make_tuple(vectorOf(linear), vectorOf(angular));
}

bool CableEngine::coupled() {
    if (!model) build();
    return !couplings.empty();
}

Real CableEngine::criticalTimeStep() {
    if (!model) build();
    int element;
    const Real strained = std::max(strainReserve, ancf_strain_max(model.get(), position.data(), &element));
    return ancf_critical_step(model.get(), strained, &element);
}

// A part of the step that the stiffest contact allows: as deep as an impact at that speed drives it, or as a cable
// strained to workingStrain presses it.
Real CableEngine::contactTimeStep(Real speed) {
    if (!model) build();
    const Scene& s = theScene();
    struct Answer {
        Real alone = 0, together = 0, force = 0; // the largest, of one point and of neighbours that touch at once
        bool touchesCables = false;
    };
    std::map<std::pair<const HollarsMat*, Real>, Answer> cables; // by material and radius
    for (size_t i = 0; i < points.size(); ++i) {
        const Body& body = *(*s.bodies)[pointIds[i]];
        Answer& answer = cables[{dynamic_cast<const HollarsMat*>(body.material.get()),
                                 static_cast<const Sphere&>(*body.shape).radius}];
        Real together = 0;
        for (int k = firstNeighbour[i]; k < firstNeighbour[i + 1]; ++k) together += neighbourCompliance[k];
        answer.touchesCables = answer.touchesCables || CablePoint::of(body)->selfContact;
        answer.alone = std::max(answer.alone, points[i].compliance);
        answer.together = std::max(answer.together, together);
        answer.force = std::max(answer.force, workingStrain * ea[pointElement[i]]);
    }
    std::set<std::pair<const ElastMat*, Real>> others; // material, curvature
    for (const auto& body : *s.bodies) {
        if (!body || !body->shape || CablePoint::of(*body)) continue;
        const auto* material = dynamic_cast<const ElastMat*>(body->material.get());
        const auto* sphere = dynamic_cast<const Sphere*>(body->shape.get());
        if (material) others.insert({material, sphere ? 1 / sphere->radius : 0});
    }
    Real least = std::numeric_limits<Real>::infinity();
    const auto limit = [&](const HollarsMat& cable, const ElastMat& other, Real curvature, const Answer& answer,
                           Real sides) { // 2 if the other one is a cable as well
        HollarsPhys phys;
        setStiffness(phys, cable, other, 1 / curvature);
        const Real k = phys.normalStiffness, n = phys.normalExponent;
        const Real impact = std::pow((n + 1) * speed * speed / (2 * k * sides * answer.alone), 1 / (n + 1));
        const Real depth = std::max(impact, std::pow(answer.force / k, 1 / n));
        const ancf_normal law = phys.normalLaw();
        const Real sum = ancf_normal_tangent(&law, depth) * sides * answer.together;
        least = std::min(least, contactReserve * 2 / std::sqrt(sum));
    };
    for (const auto& [cable, answer] : cables) {
        if (!cable.first || !(answer.alone > 0)) continue;
        for (const auto& [material, curvature] : others)
            limit(*cable.first, *material, 1 / cable.second + curvature, answer, 1);
        if (answer.touchesCables) limit(*cable.first, *cable.first, 2 / cable.second, answer, 2);
    }
    return least;
}

void CableEngine::relax(Real tolerance, int iterations) {
    if (!(tolerance > 0) || iterations < 1)
        throw std::invalid_argument(text("CableEngine.relax: tolerance = ", tolerance, ", iterations = ", iterations,
                                         ": both must be above 0"));
    Scene& s = theScene();
    build();
    if (!couplings.empty())
        refuse(
            text("relax: body ", couplings[0].id,
                 " is carried off its centre or guided, and would have to turn: let the scene come to rest instead"));
    for (const auto& engine : s.engines)
        if (const auto* newton = dynamic_cast<const NewtonIntegrator*>(engine.get())) gravity = newton->gravity;
    for (int c = 0; c < 3; ++c) model->gravity[c] = gravity[c];
    std::fill_n(model->external, position.size(), 0);
    for (size_t i = 0; i < loadNodes.size(); ++i) addNode(model.get(), model->external, loadNodes[i], loads[i]);
    const ancf_error error = ancf_equilibrium(model.get(), tolerance, iterations);
    if (error) refuse(text("relax: ", ancf_error_text(error)));
    const auto place = [&](Body::id_t id, const Vector3r& where) {
        State& state = *(*s.bodies)[id]->state;
        state.pos = where;
        state.vel = Vector3r::Zero();
    };
    for (size_t i = 0; i < points.size(); ++i) place(pointIds[i], at(model.get(), model->x, points[i]));
    for (size_t i = 0; i < carryNodes.size(); ++i) place(carryIds[i], ofNode(model.get(), model->x, carryNodes[i]));
    lastStep = lastSubstep = 0;
}

} // namespace yade
