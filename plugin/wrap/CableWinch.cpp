// SPDX-License-Identifier: GPL-2.0-or-later
// Winches at the ends of cables of springs: what is wound on a drum, how it is paid out and hauled in, and the nodes
// that come and go with it.
#include "CableEngine.hpp"

#include "Attributes.hpp"
#include "CableNodes.hpp"
#include "Guard.hpp"

extern "C" {
#include "ancf/mass.h"
#include "ancf/stability.h"
}

#include <algorithm>
#include <array>
#include <cmath>

namespace yade {

namespace {
    constexpr Real longest = .6, shortestPart = .5; // see CableEngine::knotWinch()
    constexpr Real inStep = .25;                    // part of an element that may pass in a step
    constexpr Real bentBy = .1;                     // parts of the radius by which the chord may be off, in contact

    // What CableEngine.winchNumbers holds of each.
    enum Number {
        BOTH,    // as ancf_spool
        BEYOND,  // "
        SPEED,   // of the law
        FORCE,   // "
        BRAKE,   // "
        LEAST,   // "
        MOST,    // "
        INERTIA, // as ancf_spool
        RATE,    // "
        FLOW,    // three numbers
        TENSION = FLOW + 3,
        WORK,
        AHEAD,
        KINETIC,
        KNOTTED, // energy gained by nodes that came and went [J]
        NUMBERS
    };

    // A row of elements from its drum to its far end.
    struct Row {
        int drum, far, step; // first and last element, and from one to the next
        int near;            // end of an element that is nearer to the drum
        Row(const vector<int>& rows, size_t i)
            : drum(rows[2 * i]), far(rows[2 * i + 1]), step(far < drum ? -1 : 1), near(far < drum ? 1 : 0) {}
        bool has(int element) const { return (element - drum) * step >= 0 && (far - element) * step >= 0; }
        Real sum(const vector<Real>& ofElements) const {
            Real all = 0;
            for (int e = drum; has(e); e += step) all += ofElements[e];
            return all;
        }
    };

    int countOf(const vector<int>& exits) { return static_cast<int>(exits.size()); }
} // namespace

// ---------------------------------------------------------------- what attributes may be

void CableEngine::checkWinches() const {
    const Attributes all(text("CableEngine ", family));
    const size_t n = winchExits.size(), elements = n > 0 ? length.size() : winchNodes.size();
    const string why = "one for each of winchExits", each = "one for each element, or none where there are no winches";
    all.size("winchRows", winchRows, 2 * n, "two for each of winchExits");
    all.size("winchElements", winchElements, n, why);
    all.size("winchDoes", winchDoes, n, why);
    all.size("winchScripted", winchScripted, n, why);
    all.size("winchNumbers", winchNumbers, NUMBERS * n, text(int(NUMBERS), " for each of winchExits"));
    all.size("winchNodes", winchNodes, elements, each);
    all.size("winchLengths", winchLengths, elements, each);
    const int end = static_cast<int>(length.size());
    all.within("winchExits", winchExits, 0, nNodes, "a node of nNodes");
    all.within("winchRows", winchRows, 0, end, "an element");
    all.within("winchElements", winchElements, 0, end, "an element");
    all.within("winchNodes", winchNodes, -1, nNodes, "a node of nNodes, or -1");
    all.within("winchDoes", winchDoes, 0, 4, "what a drum does");
    all.within("winchScripted", winchScripted, 0, 2, "no or yes");
    all.notNegative("winchLengths", winchLengths);
    for (int i = 0; i < countOf(winchExits); ++i) checkWinch(i);
    for (size_t e = 0; e < kind.size(); ++e)
        if (kind[e] & ANCF_WOUND) {
            bool known = false;
            for (size_t i = 0; i < n; ++i) known = known || Row(winchRows, i).has(static_cast<int>(e));
            if (!known) all.refuse("kind[", e, "] = ", kind[e], ": is wound on a drum, but winchRows has no such row");
        }
}

void CableEngine::checkWinch(int i) const {
    const Attributes all(text("CableEngine ", family));
    const Row row(winchRows, static_cast<size_t>(i));
    const int first = winchElements[i];
    vector<int> other(static_cast<size_t>(nNodes), -1);
    for (size_t k = 0; k < tiedNodes.size(); ++k) other[tiedNodes[k]] = tiedTo[k];
    const auto standing = [&](int node) { // as tied(), of lists that are being looked at
        while (other[node] >= 0) node = other[node];
        return node;
    };
    const int exit = standing(winchExits[i]);
    if (!row.has(first) || first == row.drum)
        all.refuse("winchElements[", i, "] = ", first, ": must be of its row, ", row.drum, " to ", row.far,
                   ", and not the last on the drum");
    Real beyond = 0;
    int near = exit; // node at the near end of the next element outside
    vector<int> nodes;
    for (int e = row.drum, passed = 0;; e += row.step) {
        passed |= e == first;
        const bool wound = kind[e] & ANCF_WOUND, beside = e == first || e == first - row.step;
        const int *end = &ends[2 * e], node = winchNodes[e];
        const bool tiedHere = node >= 0 && other[node] >= 0 && standing(node) == exit;
        if (!(kind[e] & ANCF_SPRING) || wound == bool(passed) || node < 0 || !(winchLengths[e] > 0) ||
            (!beside && length[e] != winchLengths[e]) || (wound && (end[0] != exit || !tiedHere)) ||
            (!wound && (end[row.near] != near || end[1 - row.near] != standing(node))))
            all.refuse("winchRows[", i, "]: element ", e, " of kind ", kind[e], ", length ", length[e], " m, the ends ",
                       end[0], " and ", end[1], ", winchNodes = ", node, " and winchLengths = ", winchLengths[e],
                       " does not fit to a cable that is wound up to element ", first, " at node ", exit);
        if (!wound) near = standing(node);
        if (passed && e != first) beyond += length[e];
        nodes.push_back(node);
        if (e == row.far) break;
    }
    all.distinct("winchNodes", nodes, "each element has one of its own");
    const Real known = winchNumbers[static_cast<size_t>(NUMBERS * i + BEYOND)];
    if (!(std::abs(known - beyond) <= 1e-9 * (beyond + length[first])))
        all.refuse("winchNumbers[", NUMBERS * i + BEYOND, "] = ", known, ": must be ", beyond,
                   " m, the length beyond element ", first);
    const Real* numbers = &winchNumbers[static_cast<size_t>(NUMBERS * i)];
    for (int k = 0; k < NUMBERS; ++k) {
        const bool bound = k == FORCE || k == BRAKE || k == MOST;
        const bool positive = k == BOTH || k == BEYOND || k == LEAST || k == INERTIA || bound;
        if (!(finite(numbers[k]) || (bound && numbers[k] == infinity)) || (positive && numbers[k] < 0))
            all.refuse("winchNumbers[", NUMBERS * i + k, "] = ", numbers[k], ": must be finite",
                       positive ? " and not below 0" : "");
    }
    const Real both = length[first] + length[first - row.step];
    if (std::abs(numbers[BOTH] - both) > 1e-9 * both)
        all.refuse("length[", first, "] = ", length[first], " and length[", first - row.step,
                   "] = ", length[first - row.step], " beside the exit of a winch: must add up to ", numbers[BOTH],
                   " m; payOut() and haul() change them");
}

// ---------------------------------------------------------------- made, and what they do

int CableEngine::wind(int drum, int far, int wound, Real inertia) {
    refuseWhileRunning("CableEngine.wind");
    needSound();
    const Attributes all("CableEngine.wind");
    const int elements = nElements(), n = std::abs(far - drum) + 1;
    if (drum < 0 || far < 0 || drum >= elements || far >= elements)
        all.refuse("drum = ", drum, ", far = ", far, ": there are ", elements, " elements");
    all.need(wound >= 1 && wound < n, "wound", wound, text("1 to ", n - 1, ", of ", n, " elements"));
    all.need(finite(inertia) && inertia >= 0, "inertia", inertia, "finite and not below 0 [kg]");
    const Row row({drum, far}, 0);
    for (size_t i = 0; i < winchExits.size(); ++i)
        if (const Row other(winchRows, i); other.has(drum) || other.has(far) || row.has(other.drum))
            all.refuse("drum = ", drum, ": its cable has a winch already");
    const int exit = ends[2 * drum + row.near];
    for (int e = drum, node = exit;; e += row.step) {
        if (!(kind[e] & ANCF_SPRING)) all.refuse("element ", e, " is no spring: use model='springs'");
        if (massDamping[e] > 0)
            all.refuse("massDamping[", e, "] = ", massDamping[e], ": must be 0 [1/s], it would brake what is wound");
        if (ends[2 * e + row.near] != node) all.refuse("element ", e, " does not begin where the one before it ends");
        node = ends[2 * e + 1 - row.near];
        if ((e - drum) * row.step < wound) {
            if (claimOf(node) || has(loadNodes, node) || has(tiedNodes, node) || has(tiedTo, node))
                all.refuse("node ", node, ", which is to be wound, is held, loaded or tied");
        }
        if (e == far) break;
    }
    const int first = drum + row.step * wound;
    winchNodes.resize(length.size(), -1);
    winchLengths.resize(length.size(), 0);
    Real beyond = 0, whole = 0;
    const int stride = getStride();
    const Vector3r at = nodeOf(position.data(), stride, exit);
    for (int k = 0; k < n; ++k) {
        const int e = drum + row.step * k, node = ends[2 * e + 1 - row.near];
        winchNodes[e] = node;
        whole += winchLengths[e] = length[e];
        if (k > wound) beyond += length[e];
        if (k >= wound) continue;
        kind[e] |= ANCF_WOUND;
        tiedNodes.push_back(node);
        tiedTo.push_back(exit);
        setNode(position.data(), stride, node, at);
        setNode(velocity.data(), stride, node, Vector3r::Zero());
    }
    for (int k = 0; k < wound; ++k)
        for (int end = 0; end < 2; ++end) ends[2 * (drum + row.step * k) + end] = exit;
    ends[2 * first + row.near] = exit;
    winchExits.push_back(exit);
    winchRows.insert(winchRows.end(), {drum, far});
    winchElements.push_back(first);
    winchDoes.push_back(ANCF_HOLDS);
    winchScripted.push_back(0);
    vector<Real> numbers(NUMBERS, 0);
    numbers[BOTH] = length[first] + length[first - row.step];
    numbers[BEYOND] = beyond;
    numbers[BRAKE] = infinity;
    numbers[LEAST] = shortestPart * winchLengths[far];
    numbers[MOST] = whole - shortestPart * winchLengths[drum];
    numbers[INERTIA] = inertia;
    winchNumbers.insert(winchNumbers.end(), numbers.begin(), numbers.end());
    standsFor.clear();
    changed();
    return countOf(winchExits) - 1;
}

void CableEngine::setWinch(int i, const py::object& speed, Real force, Real brake, Real least, Real most) {
    needSound();
    if (i < 0 || i >= countOf(winchExits))
        throw std::out_of_range(text("CableEngine.setWinch: winch = ", i, ": there are ", winchExits.size()));
    const Attributes all("CableEngine.setWinch");
    const bool script = isFunction(speed);
    const Real number = script ? 0 : static_cast<Real>(py::extract<Real>(speed));
    const Row row(winchRows, static_cast<size_t>(i));
    const Real low = shortestPart * winchLengths[row.far];
    const Real high = row.sum(winchLengths) - shortestPart * winchLengths[row.drum];
    all.need(finite(number), "speed", number, "finite, and below 1e100 [m/s]");
    all.need(force >= 0, "force", force, "not below 0 [N]");
    all.need(brake >= force, "brake", brake, text("at least the force, ", force, " N"));
    all.need(least >= low * (1 - 1e-9) && least <= most, "least", least,
             text("at least ", low, " m, half of the last element, and not above most"));
    all.need(most <= high * (1 + 1e-9), "most", most, text("at most ", high, " m: half an element stays on the drum"));
    Real* numbers = &winchNumbers[static_cast<size_t>(NUMBERS * i)];
    numbers[SPEED] = number;
    numbers[FORCE] = force;
    numbers[BRAKE] = brake;
    numbers[LEAST] = least;
    numbers[MOST] = most;
    winchScripted[i] = script;
    winchSpeeds.set(i, script ? speed : py::object());
    if (model) spools[i].law = {number, force, brake, least, most};
}

py::dict CableEngine::winch(int i) const {
    needSound();
    if (i < 0 || i >= countOf(winchExits))
        throw std::out_of_range(text("CableEngine.winch: number = ", i, ": there are ", winchExits.size()));
    const Row row(winchRows, static_cast<size_t>(i));
    const Real* numbers = &winchNumbers[static_cast<size_t>(NUMBERS * i)];
    Real wound = 0;
    for (int e = row.drum; e != winchElements[i]; e += row.step) wound += length[e];
    const Real outside = length[winchElements[i]] + numbers[BEYOND], speed = numbers[SPEED];
    const bool atLeast = outside <= numbers[LEAST] * (1 + 1e-9);
    const char* holds = speed == 0 ? "holds" : speed < 0 || atLeast ? "stopped" : "strains";
    const char* const does[] = {holds, speed > 0 ? "draws" : "lets out", "strains", "slips"};
    py::dict all;
    all["does"] = does[winchDoes[i]];
    all["tension"] = numbers[TENSION];
    all["rate"] = numbers[RATE];
    all["outside"] = outside;
    all["wound"] = wound;
    all["work"] = numbers[WORK];
    all["knotted"] = numbers[KNOTTED];
    all["least"] = shortestPart * winchLengths[row.far];
    all["most"] = outside + wound - shortestPart * winchLengths[row.drum];
    return all;
}

// ---------------------------------------------------------------- one step

// Of the attributes, for a model that was just made.
void CableEngine::makeSpools() {
    spools.clear();
    if (winchExits.empty()) return;
    if (!ancf_mass_diagonal(model.get()))
        throw std::invalid_argument(text("CableEngine ", family,
                                         " has cables of consistent mass beside one on a winch, "
                                         "whose mass changes: give them mass='lumped', or an engine of their own"));
    if (integrator != "leapfrog")
        throw std::invalid_argument(text("CableEngine ", family, ": integrator = '", integrator,
                                         "' does not know winches: use integrator = 'leapfrog'"));
    for (int i = 0; i < countOf(winchExits); ++i) {
        const Row row(winchRows, static_cast<size_t>(i));
        const Real* n = &winchNumbers[static_cast<size_t>(NUMBERS * i)];
        const int exit = tied(winchExits[i]), first = winchElements[i];
        for (size_t k = 0; k < carryNodes.size(); ++k)
            if (carryNodes[k] == exit && carrierOf(carryIds[k]) < 0)
                throw std::invalid_argument(text("CableEngine ", family, ": node ", exit, ", at which winch ", i,
                                                 " sits, carries body ", carryIds[k],
                                                 " off its centre or on a guide: carry it at (0, 0, 0)"));
        for (int e = row.drum; row.has(e); e += row.step) {
            if (massDamping[e] > 0)
                throw std::invalid_argument(text("CableEngine ", family, ": massDamping[", e, "] = ", massDamping[e],
                                                 ": must be 0 [1/s] for a cable on a winch, as it would brake what is "
                                                 "wound; use damping"));
            for (const int node : {exit, tied(winchNodes[e])})
                if (has(slideNodes, node))
                    throw std::invalid_argument(text("CableEngine ", family, ": node ", node, " of a cable on winch ",
                                                     i, " slides along a line: fix it, or release it"));
        }
        const int moved[] = {exit, ends[2 * first + 1 - row.near]};
        for (const ancf_spool& other : spools)
            for (const int node : moved)
                if (node == other.node || node == ends[2 * other.element] || node == ends[2 * other.element + 1])
                    throw std::invalid_argument(
                        text("CableEngine ", family, ": node ", node, " is beside the drums of winches ",
                             &other - spools.data(), " and ", i,
                             ", and can be so of one: carry a body at each of two nodes, or haul(to=) less"));
        ancf_spool s {};
        s.node = exit;
        s.element = first;
        s.store = first - row.step;
        s.both = n[BOTH];
        s.beyond = n[BEYOND];
        s.capacity = row.sum(winchLengths) - shortestPart * winchLengths[row.drum];
        s.law = {n[SPEED], n[FORCE], n[BRAKE], n[LEAST], n[MOST]};
        s.inertia = n[INERTIA];
        s.rate = n[RATE];
        std::copy_n(n + FLOW, 3, s.flow);
        s.does = winchDoes[i];
        s.tension = n[TENSION];
        s.work = n[WORK];
        s.ahead = n[AHEAD];
        s.kinetic = n[KINETIC];
        s.next = length[first];
        if (ancf_spool_join(&s, model.get())) throw std::bad_alloc();
        spools.push_back(s);
    }
}

void CableEngine::keepSpools() {
    for (size_t i = 0; i < spools.size(); ++i) {
        const ancf_spool& s = spools[i];
        Real* n = &winchNumbers[NUMBERS * i];
        n[BOTH] = s.both;
        n[BEYOND] = s.beyond;
        n[RATE] = s.rate;
        std::copy_n(s.flow, 3, n + FLOW);
        n[TENSION] = s.tension;
        n[WORK] = s.work;
        n[AHEAD] = s.ahead;
        n[KINETIC] = s.kinetic;
        winchDoes[i] = s.does;
        length[s.element] = s.next;
        length[s.store] = s.both - s.next;
    }
}

// Speeds that are functions of time, in the middle of the step.
void CableEngine::askWinches() {
    needSound();
    for (int i = 0; i < countOf(winchExits); ++i) {
        if (!winchScripted[i]) continue;
        const string which = text("the speed of winch ", i);
        if (!winchSpeeds.has(i)) refuse(which + ", a Python function of time, is not saved with a scene: haul() again");
        const Real speed = winchSpeeds(i, scene->time + scene->dt / 2, text("CableEngine ", family, ", ", which));
        winchNumbers[static_cast<size_t>(NUMBERS * i + SPEED)] = speed;
        if (model) spools[i].law.speed = speed;
    }
}

void CableEngine::feedWinches(const ancf_time& time) {
    for (ancf_spool& s : spools) {
        ancf_spool_feed(&s, model.get(), &time);
        const Real passed = std::abs(s.rate) * scene->dt, most = inStep * winchLengths[s.element];
        if (passed > most) {
            dropModel(); // nothing has moved
            refuse(text("at iteration ", scene->iter, " winch ", &s - spools.data(), " feeds ", passed,
                        " m in a step, more than a quarter of an element: use O.dt <= ", scene->dt * most / passed,
                        " s, longer elements, or a lower speed or brake"));
        }
        for (int end = 0; end < 2; ++end) touching.renew(model.get(), ends[2 * s.element + end]);
    }
}

void CableEngine::endWinches() {
    for (ancf_spool& s : spools) {
        ancf_spool_end(&s, model.get());
        for (int end = 0; end < 2; ++end) touching.renew(model.get(), ends[2 * s.element + end]);
    }
}

// Of all, up to the positions that the last step of the cables started from, and what nodes brought and took [J].
Real CableEngine::winchWork() const {
    Real sum = 0;
    for (size_t i = 0; i < spools.size(); ++i) sum += spools[i].work + winchNumbers[NUMBERS * i + KNOTTED];
    return sum;
}

// By which winches may change the length of an element at most [m/s].
Real CableEngine::winchRate() const {
    Real most = 0;
    for (const ancf_spool& s : spools) most = std::max({most, std::abs(s.law.speed), std::abs(s.rate)});
    return most;
}

// With each element as short as it may become beside a drum; see knotWinch().
Real CableEngine::stableStep(Real strain, int* element) const {
    Real least = ancf_critical_step(model.get(), strain, element);
    for (size_t i = 0; i < winchExits.size(); ++i) {
        const Row row(winchRows, i);
        for (int e = row.drum; row.has(e); e += row.step) {
            ancf_element shortOne = model->element[e];
            const Real beyond = e == row.far ? winchLengths[e] : winchLengths[e + row.step];
            shortOne.length = shortestPart * std::min(winchLengths[e], beyond);
            const Real step = ancf_element_step(&shortOne, strain);
            if (step >= least) continue;
            least = step;
            *element = e;
        }
    }
    return least;
}

// ---------------------------------------------------------------- nodes that come and go

// Whether contacts push a node out of the chord that will take its place, which would jump into what they are with.
bool CableEngine::bentAroundSomething(int i, int node) const {
    Vector3r impulse = Vector3r::Zero();
    touching.impulseOn(impulse, model.get(), node);
    if (impulse.isZero(0)) return false;
    const Row row(winchRows, static_cast<size_t>(i));
    const int beyond = spools[i].element + row.step, stride = getStride();
    const Vector3r exit = nodeOf(position.data(), stride, spools[i].node),
                   chord = nodeOf(position.data(), stride, ends[2 * beyond + 1 - row.near]) - exit,
                   off = nodeOf(position.data(), stride, node) - exit;
    return chord.cross(off).norm() > bentBy * touching.view()->cover[beyond].radius * chord.norm();
}

void CableEngine::checkClaimed(int i, int goes) const {
    const int node = tied(goes);
    const char* claim = has(fixedNodes, node)               ? "is fixed"
                        : has(followNodes, node)            ? "follows a body"
                        : has(carryNodes, node)             ? "carries a body"
                        : has(loadNodes, node)              ? "is loaded"
                        : node != goes || has(tiedTo, node) ? "is tied to another"
                                                            : nullptr;
    for (const Pulls& one : pulls)
        for (const auto& [pulled, force] : one.forces)
            if (pulled == node) claim = "is a place of a line";
    if (bentAroundSomething(i, node)) claim = "is bent around what it touches";
    if (claim)
        refuse(text("at iteration ", scene->iter, " node ", goes, " comes to the drum of winch ", i, " and ", claim,
                    ": haul(to=) at least ", spools[i].beyond, " m, or release it before"));
}

// After a step: where the first element has become so long or short that a node comes, or goes, it does.
void CableEngine::finishWinches() {
    keepSpools();
    bool any = false;
    for (int i = 0; i < countOf(winchExits); ++i) any = knotWinch(i) || any;
    if (any) rebuildKnotted();
}

// The next InteractionLoop finds places on the new elements; what is read until then is of the step that was. Numbers
// of nodes and elements are the same.
void CableEngine::rebuildKnotted() {
    const auto fields = [](ancf_model* m) {
        const size_t nodes = 3 * static_cast<size_t>(m->stride), elements = 3 * static_cast<size_t>(m->n_elements);
        return std::array {std::pair(m->f, nodes), std::pair(m->a, nodes), std::pair(m->external, nodes),
                           std::pair(m->pull, elements)};
    };
    vector<vector<Real>> of;
    for (const auto& [field, size] : fields(model.get())) of.emplace_back(field, field + size);
    const Real moved = movedBy;
    const bool unloaded = model->unloaded;
    standsFor.clear();
    try {
        build();
    } catch (const std::invalid_argument& error) { // a ValueError is a RuntimeError of a step
        throw std::runtime_error(error.what());
    }
    size_t k = 0;
    for (const auto& [field, size] : fields(model.get())) std::copy_n(of[k++].begin(), size, field);
    model->unloaded = unloaded;
    loaded = stepped = true;
    movedBy = moved;
}

// The first element is longer than it was laid by more than 0.6 of the next one on the drum, or shorter than half:
// after that it is 0.6 to 1.5 times as long, so that it does not change to and fro.
bool CableEngine::knotWinch(int i) {
    ancf_spool& s = spools[i];
    const ancf_model* m = model.get();
    const Row row(winchRows, static_cast<size_t>(i));
    const int e = s.element, beyond = e + row.step, store = s.store, stride = getStride();
    const auto& laid = winchLengths;
    ancf_knotting node;
    if (store != row.drum && s.next > laid[e] + longest * laid[store]) {
        const int comes = winchNodes[store], last = store - row.step;
        ancf_spool_split(&node, &s, m, laid[e], lastStep);
        setNode(position.data(), stride, comes, Vector3r(node.x));
        setNode(velocity.data(), stride, comes, Vector3r(node.v));
        const auto at = std::find(tiedNodes.begin(), tiedNodes.end(), comes) - tiedNodes.begin();
        tiedNodes.erase(tiedNodes.begin() + at);
        tiedTo.erase(tiedTo.begin() + at);
        kind[store] &= ~ANCF_WOUND;
        ends[2 * store + 1 - row.near] = ends[2 * e + row.near] = comes;
        s.both += laid[last] - laid[e];
        length[e] = laid[e];
        s.element = store;
        s.store = last;
    } else if (e != row.far && s.next < shortestPart * std::min(laid[e], laid[beyond])) {
        const int goes = winchNodes[e], end = ends[2 * beyond + 1 - row.near];
        checkClaimed(i, goes);
        ancf_spool_merge(&node, &s, m, beyond, lastStep);
        if (!m->hold[end]) setNode(velocity.data(), stride, end, Vector3r(node.v));
        setNode(position.data(), stride, goes, nodeOf(position.data(), stride, s.node));
        setNode(velocity.data(), stride, goes, Vector3r::Zero());
        tiedNodes.push_back(goes);
        tiedTo.push_back(s.node);
        kind[e] |= ANCF_WOUND;
        for (int k = 0; k < 2; ++k) ends[2 * e + k] = s.node;
        ends[2 * beyond + row.near] = s.node;
        s.both += laid[beyond] - laid[store];
        length[store] = laid[store];
        s.element = beyond;
        s.store = e;
    } else {
        return false;
    }
    if (!m->hold[s.node]) setNode(velocity.data(), stride, s.node, Vector3r(node.exit));
    winchElements[i] = s.element;
    winchNumbers[static_cast<size_t>(NUMBERS * i + KNOTTED)] += node.energy;
    keepSpools();
    return true;
}

} // namespace yade
