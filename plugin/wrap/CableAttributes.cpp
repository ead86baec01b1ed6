// SPDX-License-Identifier: GPL-2.0-or-later
// What the attributes of a CableEngine may be. All that comes in by keywords, updateAttrs, an attribute of its own or a
// loaded scene passes here before it is used.
#include "Attributes.hpp"
#include "CableEngine.hpp"
#include "CableNodes.hpp"
#include "Drive.hpp"

#include <array>

namespace yade {

namespace {
    // An element by its number, and by that in its cable or net.
    string elementText(const CableEngine& cable, int e) {
        const auto i = static_cast<size_t>(e);
        if (i >= cable.structure.size() || cable.structure[i] <= 0) return text("element ", e);
        return text("element ", e, ", number ", e - cable.structure[i], " of its cable or net");
    }

    // The attribute and value for which an element is refused.
    string culprit(ancf_error error, const ancf_def& def, int e) {
        if (error == ANCF_E_STATE) return "position or velocity";
        const ancf_element& el = def.element[e];
        const bool badEa = !(std::isfinite(el.ea) && el.ea > 0);
        switch (error) {
        case ANCF_E_NODE:
            return text("ends = (", def.ends[2 * e], ", ", def.ends[2 * e + 1], ")");
        case ANCF_E_NEXT:
            return text("next = ", def.next[e]);
        case ANCF_E_KIND:
            return text("kind = ", el.kind);
        case ANCF_E_LENGTH:
            return text("length = ", el.length, " m");
        case ANCF_E_STIFFNESS:
            return badEa ? text("ea = ", el.ea, " N") : text("ei = ", el.ei, " N m²");
        case ANCF_E_MASS:
            return text("rhoA = ", el.rho_a, " kg/m");
        case ANCF_E_DAMPING:
            return text("kelvinVoigt = ", el.damping, " s");
        case ANCF_E_DRAG:
            return text("massDamping = ", el.drag, " 1/s");
        case ANCF_E_SPRING:
            return text("kind = ", el.kind, " with ei = ", el.ei, " N m²");
        default:
            return "";
        }
    }

    // Why a definition is refused: of an element that `element` names, or of a node.
    string faultText(ancf_error error, const ancf_def& def, int where, const string& element) {
        const string place = error == ANCF_E_LOOSE ? text("node ", where, " of ends, tiedNodes and nNodes")
                                                   : text(element, ": ", culprit(error, def, where));
        return text(place, ": ", ancf_error_text(error));
    }

    void checkSettings(const Attributes& all, const CableEngine& c) {
        all.need(has<string>({"leapfrog", "implicit", "rk4"}, c.integrator), "integrator", c.integrator,
                 "'leapfrog', 'implicit' or 'rk4'");
        all.need(has<string>({"nonlinear", "hertz", "linear"}, c.normal), "normal", c.normal,
                 "'nonlinear', 'hertz' or 'linear'");
        all.need(has<string>({"hollars", "coulomb", "none"}, c.friction), "friction", c.friction,
                 "'hollars', 'coulomb' or 'none'");
        all.need(c.spectralRadius >= 0 && c.spectralRadius <= 1, "spectralRadius", c.spectralRadius, "from 0 to 1");
        all.need(c.substeps >= 0 && c.substeps <= CableEngine::substepsMost, "substeps", c.substeps,
                 text("0 (as many as it needs) to ", CableEngine::substepsMost));
        all.need(c.energyTolerance > 0, "energyTolerance", c.energyTolerance,
                 "above 0, a share of the energy; inf: no watch");
        all.need(finite(c.energyScale) && c.energyScale >= 0, "energyScale", c.energyScale,
                 "finite and not below 0 [J]");
        all.need(finite(c.lastStep) && c.lastStep >= 0, "lastStep", c.lastStep, "finite and not below 0 [s]");
        all.need(finite(c.gravity), "gravity", c.gravity, "finite [m/s²]");
        all.need(finite(c.twistLeft), "twistLeft", c.twistLeft, "finite [N m s]");
        all.need(finite(c.maxPenetration), "maxPenetration", c.maxPenetration, "finite [m]");
    }

    void checkField(const Attributes& all, const CableEngine& c, const char* name, const vector<Real>& field) {
        const bool any = c.nNodes > 0 || !c.length.empty();
        all.size(
            name, field, any ? 3 * static_cast<size_t>(c.getStride()) : 0,
            text("3 blocks of stride, for nNodes = ", c.nNodes, " and the ", c.length.size(), " values of length"));
        all.finiteEach(name, field);
    }

    void checkState(const Attributes& all, const CableEngine& c) {
        all.need(c.nNodes >= 0, "nNodes", c.nNodes, "0 or more");
        if (static_cast<size_t>(c.nNodes) + 2 * c.length.size() >
            static_cast<size_t>(std::numeric_limits<int>::max() / 8))
            all.refuse("nNodes = ", c.nNodes, " with ", c.length.size(), " elements: too many");
        checkField(all, c, "position", c.position);
        checkField(all, c, "velocity", c.velocity);
        all.finiteEach("acceleration", c.acceleration);
    }

    void checkElements(const Attributes& all, const CableEngine& c) {
        const size_t n = c.length.size();
        const string why = "one for each value of length";
        all.size("ends", c.ends, 2 * n, "two for each value of length");
        all.size("next", c.next, n, why);
        all.size("kind", c.kind, n, why);
        for (const auto& [name, list] : {std::pair("length", &c.length), std::pair("ea", &c.ea), std::pair("ei", &c.ei),
                                         std::pair("rhoA", &c.rhoA), std::pair("kelvinVoigt", &c.kelvinVoigt),
                                         std::pair("massDamping", &c.massDamping)}) {
            all.size(name, *list, n, why);
            all.finiteEach(name, *list);
        }
        all.within("ends", c.ends, 0, c.nNodes, "a node of nNodes");
        all.within("next", c.next, -1, static_cast<int>(n), "an element, or -1 for none");
        if (n == 0) return;
        vector<ancf_element> elements;
        for (size_t i = 0; i < n; ++i)
            elements.push_back(
                {c.kind[i], c.length[i], c.ea[i], c.ei[i], c.rhoA[i], c.kelvinVoigt[i], c.massDamping[i]});
        vector<int> hold(static_cast<size_t>(c.nNodes) + 2 * n, ANCF_FREE);
        for (const int node : c.tiedNodes) // another stands for them
            if (node >= 0 && node < c.nNodes) hold[static_cast<size_t>(node)] = ANCF_HELD;
        const ancf_def def = {
            c.nNodes, static_cast<int>(n), elements.data(), c.ends.data(), c.next.data(), nullptr, hold.data(), 0,
            nullptr};
        int where = 0;
        const ancf_error error = ancf_model_check(&def, c.position.data(), c.velocity.data(), &where);
        if (error) all.refuse(faultText(error, def, where, elementText(c, where)));
    }

    // What the elements show to the outside: of all, or of those before what was added last.
    void checkCovers(const Attributes& all, const CableEngine& c) {
        const size_t n = c.radius.size(), elements = c.length.size();
        const int end = static_cast<int>(elements);
        if (n > elements) all.size("radius", c.radius, elements, "one for each element");
        const string why = text("one for each element, as radius has");
        for (const auto& [name, list] :
             {std::pair("segments", &c.segments), std::pair("points", &c.points), std::pair("structure", &c.structure),
              std::pair("selfContact", &c.selfContact), std::pair("run", &c.run)})
            all.size(name, *list, n, why);
        all.size("arc", c.arc, n, why);
        all.size("closed", c.closed, n, why);
        if (c.elementIds.size() != elements) all.size("elementIds", c.elementIds, n, why);
        all.each("radius", c.radius, "finite and above 0 [m]", [](Real value) { return finite(value) && value > 0; });
        all.within("segments", c.segments, 1, CableEngine::segmentsMost + 1, "a number of segments");
        all.within("points", c.points, 0, 2, "no or yes");
        all.within("selfContact", c.selfContact, 0, 2, "no or yes");
        all.within("structure", c.structure, 0, end, "the first element of a cable or net");
        all.within("run", c.run, 0, end, "the first element of a row");
        all.notNegative("arc", c.arc);
        all.notNegative("closed", c.closed);
        all.each("elementIds", c.elementIds, "a body, or -1 for none", [](int id) { return id >= -1; });
        vector<int> ids;
        for (size_t e = 0; e < c.elementIds.size(); ++e) {
            if (c.elementIds[e] < 0) continue;
            if (e >= n)
                all.refuse("elementIds[", e, "] = ", c.elementIds[e], ": must be -1 as long as radius has ", n,
                           " values: cover() the element first");
            ids.push_back(c.elementIds[e]);
        }
        all.distinct("elementIds", ids, "each element has a body of its own");
    }

    // What stands for a node must be a node that nothing stands for, in the end.
    void checkTies(const Attributes& all, const CableEngine& c) {
        all.size("tiedTo", c.tiedTo, c.tiedNodes.size(), "one for each of tiedNodes");
        all.within("tiedNodes", c.tiedNodes, 0, c.nNodes, "a node of nNodes");
        all.within("tiedTo", c.tiedTo, 0, c.nNodes, "a node of nNodes");
        all.distinct("tiedNodes", c.tiedNodes, "one node alone stands for another");
        vector<int> other(static_cast<size_t>(c.nNodes), -1), seen(other); // seen: by which walk
        for (size_t i = 0; i < c.tiedNodes.size(); ++i) other[c.tiedNodes[i]] = c.tiedTo[i];
        for (size_t i = 0; i < c.tiedNodes.size(); ++i)
            for (int node = c.tiedNodes[i]; other[node] >= 0 && seen[node] < 0; node = other[node]) {
                seen[node] = static_cast<int>(i);
                if (seen[other[node]] == static_cast<int>(i))
                    all.refuse("tiedTo[", i, "] = ", c.tiedTo[i], ": tiedNodes and tiedTo lead from node ",
                               c.tiedNodes[i], " around a circle: must end at a node that is not tied");
            }
        for (size_t k = 0; k < c.ends.size(); ++k)
            if (other[c.ends[k]] >= 0)
                all.refuse("ends[", k, "] = ", c.ends[k],
                           ": this node is in tiedNodes: must be the one that stands for it");
        for (const int end : c.ends) other[end] = end;
        for (int node = 0; node < c.nNodes; ++node)
            if (other[node] < 0)
                all.refuse("nNodes = ", c.nNodes, ": node ", node,
                           " is neither in ends nor in tiedNodes: must be one of them");
    }

    // A node is one of these at most: fixed, follows a body, slides, carries a body, is tied to another node.
    void checkHolds(const Attributes& all, const CableEngine& c) {
        const int slopes = 2 * static_cast<int>(c.length.size());
        all.within("fixedNodes", c.fixedNodes, 0, c.nNodes, "a node of nNodes");
        all.within("clampedEnds", c.clampedEnds, 0, slopes, "2 element + end");
        all.distinct("clampedEnds", c.clampedEnds, "once is enough");
        all.size("followSlopes", c.followSlopes, c.followEnds.size(), "one for each of followEnds");
        all.within("followEnds", c.followEnds, 0, slopes, "2 element + end");
        all.distinct("followEnds", c.followEnds, "once is enough");
        all.finiteEach("followSlopes", c.followSlopes);
        for (const auto& [name, list] :
             {std::pair("clampedEnds", &c.clampedEnds), std::pair("followEnds", &c.followEnds)})
            for (const int end : *list)
                if (c.kind[end / 2] & ANCF_SPRING)
                    all.refuse(name, " holds ", end, ": ", elementText(c, end / 2), " is a spring, which has no slope");
        all.size("followIds", c.followIds, c.followNodes.size(), "one for each of followNodes");
        all.size("followAt", c.followAt, c.followNodes.size(), "one for each of followNodes");
        all.within("followNodes", c.followNodes, 0, c.nNodes, "a node of nNodes");
        all.finiteEach("followAt", c.followAt);
        for (const int end : c.followEnds)
            if (has(c.clampedEnds, end) || !has(c.followNodes, c.ends[end]))
                all.refuse("followEnds holds ", end, ": its node ", c.ends[end],
                           " must be in followNodes, and it not in clampedEnds");
        all.within("slideNodes", c.slideNodes, 0, c.nNodes, "a node of nNodes");
        all.distinct("slideNodes", c.slideNodes, "one line for each");
        all.size("slideAlong", c.slideAlong, c.slideNodes.size(), "one for each of slideNodes");
        all.size("slideAt", c.slideAt, c.slideNodes.size(), "one for each of slideNodes");
        all.each("slideAlong", c.slideAlong, "a unit vector",
                 [](const Vector3r& d) { return std::abs(d.squaredNorm() - 1) < 1e-12; });
        all.finiteEach("slideAt", c.slideAt);
        for (size_t i = 0; i < c.slideNodes.size(); ++i) {
            const Vector3r way = nodeOf(c.position.data(), c.getStride(), c.slideNodes[i]) - c.slideAt[i];
            const Real off = (way - c.slideAlong[i].dot(way) * c.slideAlong[i]).norm();
            if (!(off <= 1e-9 * (1 + c.slideAt[i].norm())))
                all.refuse("slideAt[", i, "]: node ", c.slideNodes[i], " of position is ", off,
                           " m off its line: must be on it");
        }
        all.size("carryIds", c.carryIds, c.carryNodes.size(), "one for each of carryNodes");
        all.size("carryAt", c.carryAt, c.carryNodes.size(), "one for each of carryNodes");
        all.within("carryNodes", c.carryNodes, 0, c.nNodes, "a node of nNodes");
        all.finiteEach("carryAt", c.carryAt);
        if (c.carryReaction.size() > c.carryNodes.size())
            all.size("carryReaction", c.carryReaction, c.carryNodes.size(), "one for each of carryNodes");
        all.finiteEach("carryReaction", c.carryReaction);
        all.size("loads", c.loads, c.loadNodes.size(), "one for each of loadNodes");
        all.within("loadNodes", c.loadNodes, 0, c.nNodes, "a node of nNodes");
        all.distinct("loadNodes", c.loadNodes, "one force on each");
        all.finiteEach("loads", c.loads);
        vector<const char*> claim(static_cast<size_t>(c.nNodes), nullptr);
        for (const auto& [name, list] :
             {std::pair("tiedNodes", &c.tiedNodes), std::pair("fixedNodes", &c.fixedNodes),
              std::pair("followNodes", &c.followNodes), std::pair("slideNodes", &c.slideNodes),
              std::pair("carryNodes", &c.carryNodes)})
            for (const int node : *list) {
                if (claim[node])
                    all.refuse(name, " holds node ", node, ", which is in ", claim[node], ": one of them at most");
                claim[node] = name;
            }
        for (const int node : c.loadNodes)
            if (claim[node] && string(claim[node]) == "tiedNodes")
                all.refuse("loadNodes holds node ", node,
                           ", which is in tiedNodes: must be the one that stands for it");
    }

    void checkSections(const Attributes& all, const CableEngine& c) {
        const size_t n = c.sectionMaterials.size();
        all.size("sections", c.sections, 2 * n, "two for each of sectionMaterials");
        all.size("sectionBends", c.sectionBends, n, "one for each of sectionMaterials");
        all.size("sectionYoung", c.sectionYoung, n, "one for each of sectionMaterials");
        all.size("sectionDensity", c.sectionDensity, n, "one for each of sectionMaterials");
        all.within("sections", c.sections, 0, c.nElements() + 1, "elements, first and end");
        all.within("sectionBends", c.sectionBends, 0, 2, "no or yes");
        const auto positive = [](Real value) { return finite(value) && value > 0; };
        all.each("sectionYoung", c.sectionYoung, "finite and above 0 [Pa]", positive);
        all.each("sectionDensity", c.sectionDensity, "finite and above 0 [kg/m³]", positive);
    }

    // What the next step remembers: contacts between cables, and the watches over it.
    void checkMemory(const Attributes& all, const CableEngine& c) {
        const size_t n = c.crossPairs.size() / 3;
        all.size("crossPairs", c.crossPairs, 3 * n, "three for each contact");
        all.size("crossValues", c.crossValues, 9 * n, "nine for each contact of crossPairs");
        all.finiteEach("crossValues", c.crossValues);
        all.finiteEach("openAccounts", c.openAccounts);
        all.finiteEach("watched", c.watched);
        all.finiteEach("balance", c.balance);
    }
} // namespace

void CableEngine::checkAttributes() const {
    const Attributes all(text("CableEngine ", family));
    checkSettings(all, *this);
    checkState(all, *this);
    checkElements(all, *this);
    checkCovers(all, *this);
    checkTies(all, *this);
    checkHolds(all, *this);
    checkSections(all, *this);
    checkMemory(all, *this);
}

void CableEngine::checkDef(const char* what, const ancf_def& def, const Real* x, const Real* v) {
    int where = 0;
    const ancf_error error = ancf_model_check(&def, x, v, &where);
    if (error == ANCF_E_EMPTY) throw std::invalid_argument(text(what, ": ", ancf_error_text(error)));
    if (error) throw std::invalid_argument(text(what, ": ", faultText(error, def, where, text("element ", where))));
}

void CableEngine::needSound() const {
    if (sound) return;
    checkAttributes();
    sound = true;
}

const Body& CableEngine::heldBody(const char* what, Body::id_t id) const {
    const Body& body = bodyOf(theScene(), id, what);
    if (CableElement::of(body))
        throw std::invalid_argument(
            text("CableEngine.", what, ": body ", id, " is an element of a cable: tie() their nodes instead"));
    return body;
}

const Body& CableEngine::followedBody(Body::id_t id) const {
    const Body &body = heldBody("follow", id), &moved = movedBody(theScene(), body);
    if (moved.isDynamic() && moved.state->blockedDOFs != State::DOF_ALL)
        throw std::invalid_argument(text(
            "CableEngine.follow: body ", id,
            " moves freely and would not feel the cable, its force nor the moment of a clamp: block all its freedoms "
            "and lead it, or use carry"));
    return body;
}

const Body& CableEngine::carriedBody(Body::id_t id) const {
    const Body& body = heldBody("carry", id);
    if (body.isClumpMember())
        throw std::invalid_argument(
            text("CableEngine.carry: body ", id, " is a clump's member: carry the clump, ", body.clumpId));
    if (!(finite(body.state->mass) && body.state->mass > 0))
        throw std::invalid_argument(
            text("CableEngine.carry: body ", id, " has mass ", body.state->mass, ": must be finite and above 0 [kg]"));
    return body;
}

void CableEngine::checkHeldBodies() const {
    for (const Body::id_t id : followIds) followedBody(id);
    for (const Body::id_t id : carryIds) carriedBody(id);
}

void CableEngine::checkElementBody(int element) const {
    const Body& body = elementBody(element);
    const CableElement* shape = CableElement::of(body);
    if (!shape)
        refuse(text("elementIds[", element, "] = ", body.id, ": this body is no CableElement, but a ",
                    body.shape ? body.shape->getClassName() : "body without shape"));
    if (shape->element != element || shape->family != family)
        refuse(text("elementIds[", element, "] = ", body.id, ": this body's shape.element = ", shape->element,
                    " and shape.family = ", shape->family, ": must be ", element, " and ", family));
    if (shape->radius != radius[element])
        refuse(text("body ", body.id, " of element ", element, ": shape.radius = ", shape->radius,
                    " m: must be that of the engine, radius[", element, "] = ", radius[element], " m"));
}

// A step that is not a number or 0 would pass for any.
void CableEngine::checkCriticalStep(Real step, int e) const {
    if (step > 0 && std::isfinite(step)) return;
    throw std::invalid_argument(text("CableEngine ", family, ": ", elementText(*this, e), ": length = ", length[e],
                                     " m, ea = ", ea[e], " N, ei = ", ei[e], " N m², rhoA = ", rhoA[e],
                                     " kg/m, kelvinVoigt = ", kelvinVoigt[e], " s and massDamping = ", massDamping[e],
                                     " 1/s give a critical step of ", step,
                                     " s: must be finite and above 0; take values of a real cable"));
}

// Where the model reads it, if there is one.
void CableEngine::setField(vector<Real>& field, const char* name, const vector<Real>& value) {
    checkField(Attributes(text("CableEngine ", family)), *this, name, value);
    if (field.size() == value.size()) std::copy(value.begin(), value.end(), field.begin());
    else field = value;
    moveLines();
    if (!model) return;
    theScene().doSort = true;
    if (!slideNodes.empty()) { // the model has the lines
        changed();
        return;
    }
    touching.disturb();
    watchedStep = 0; // looks at all strains in the next step
    balanced = false;
}

} // namespace yade
