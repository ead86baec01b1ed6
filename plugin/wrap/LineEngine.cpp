// SPDX-License-Identifier: GPL-2.0-or-later
#include "LineEngine.hpp"

#include "Attributes.hpp"
#include "CableEngine.hpp"
#include "LateError.hpp"
#include "Mobility.hpp"

#include <core/Omega.hpp>
#include <pkg/dem/NewtonIntegrator.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace yade {

YADE_PLUGIN((LineEngine))

namespace {
    constexpr long lookInterval = 100; // steps between two looks at the step
    constexpr Real safety = .9;        // of a step that would just be stable, as for cables
    constexpr Real nearer = .25;       // part of their way to which rings without a size, or without friction, may come
} // namespace

void LineEngine::refuse(const string& why) const { throw std::runtime_error(text("LineEngine '", name, "': ", why)); }

string LineEngine::placeText(size_t i) const {
    const string what =
        families[i] < 0 ? text("body ", numbers[i]) : text("node ", numbers[i], " of CableEngine ", families[i]);
    return text("place ", i, " of families and numbers (", what, ")");
}

Scene& LineEngine::theScene() const { return *Omega::instance().getScene(); } // ours may be that of before a load

CableEngine* LineEngine::findCable(int family) const {
    CableEngine* found = CableEngine::of(theScene(), family);
    for (CableEngine* other : others)
        if (!found && other->family == family) found = other;
    return found;
}

CableEngine& LineEngine::cable(size_t i) const {
    CableEngine* found = findCable(families[i]);
    if (!found) refuse(placeText(i) + ": there is no such engine in O.engines: put it there, after this one");
    return *found;
}

const Body& LineEngine::bodyAt(size_t i) const {
    const Scene& s = theScene();
    if (!s.bodies->exists(numbers[i])) refuse(placeText(i) + " was erased: take this engine out of O.engines as well");
    return *(*s.bodies)[numbers[i]];
}

// ---------------------------------------------------------------- what attributes may be

void LineEngine::checkLists() const {
    const Attributes all("LineEngine");
    const size_t n = numbers.size();
    const string places = text("one for each of ", n, " numbers"), spans = "one for each span",
                 ends = "one for each end";
    all.need(n >= 2, "numbers", n, "those of two places at least");
    all.size("families", families, n, places);
    all.size("offsets", offsets, n, places);
    all.size("friction", friction, n, places);
    all.size("slides", slides, n, places);
    all.size("flow", flow, n, places);
    all.size("length", length, n - 1, spans);
    all.size("tension", tension, n - 1, spans);
    all.each("families", families, "that of a CableEngine, or -1 for a body", [](int i) { return i >= -1; });
    all.each("numbers", numbers, "a node or a body", [](int i) { return i >= 0; });
    all.finiteEach("offsets", offsets);
    all.finiteEach("flow", flow);
    all.finiteEach("leftForce", leftForce);
    all.finiteEach("leftTorque", leftTorque);
    all.notNegative("friction", friction);
    all.notNegative("tension", tension);
    all.each("length", length, "finite and at least 1e-9 [m]", [](Real l) { return finite(l) && l >= 1e-9; });
    all.need(finite(ea) && ea > 0, "ea", ea, "finite and above 0 [N]");
    all.need(finite(ringRadius) && ringRadius >= 0, "ringRadius", ringRadius, "finite and not below 0 [m]");
    all.need(finite(diameter) && diameter >= 0, "diameter", diameter, "finite and not below 0 [m]");
    for (const auto& [what, list] : {std::pair("speed", &speed), std::pair("force", &force), std::pair("brake", &brake),
                                     std::pair("least", &least), std::pair("most", &most)})
        all.size(what, *list, 2, ends);
    all.size("scripted", scripted, 2, ends);
    all.within("scripted", scripted, 0, 2, "no or yes");
    all.finiteEach("speed", speed);
    all.notNegative("force", force);
    all.notNegative("least", least);
    all.each("most", most, "not below 0 [m]", [](Real l) { return l >= 0; });
    all.each("brake", brake, "not below 0 [N]", [](Real b) { return b >= 0; });
    for (size_t end = 0; end < 2; ++end)
        all.need(force[end] <= brake[end], "force", force[end], text("at most the brake's, ", brake[end], " N"));
    for (size_t i = 0; i < n; ++i) {
        const bool ring = i > 0 && i + 1 < n;
        all.need(slides[i] >= (ring ? -1 : 0) && slides[i] <= (ring ? 1 : 3), "slides", slides[i],
                 ring ? "-1, 0 or 1 for a ring" : "0 to 3 for an end");
    }
    all.need(finite(rubbed), "rubbed", rubbed, "finite [J]");
    all.need(finite(drawn), "drawn", drawn, "finite [J]");
}

void LineEngine::needSound() {
    if (!sound) checkLists();
    sound = true;
}

void LineEngine::postLoad(LineEngine&) {
    sound = false;
    if (!numbers.empty()) needSound();
}

// What moves its places comes after it, and nothing in between forgets what it pulls at bodies.
void LineEngine::checkOrder() const {
    bool found = false, reset = false;
    for (const auto& engine : theScene().engines) {
        if (found && engine.get() == this) refuse("stands in O.engines twice: take one of them out");
        found = found || engine.get() == this;
        reset = reset || (found && engine->getClassName() == "ForceResetter");
        const auto* cables = dynamic_cast<const CableEngine*>(engine.get());
        if (cables && !found && std::find(families.begin(), families.end(), cables->family) != families.end())
            refuse(text("stands behind CableEngine ", cables->family, " in O.engines: put it before it"));
        if (!dynamic_cast<const NewtonIntegrator*>(engine.get())) continue;
        if (!found) refuse("stands behind NewtonIntegrator in O.engines: put it before it");
        if (reset) refuse("stands before ForceResetter in O.engines, which takes away what it pulls: put it behind it");
    }
}

// That places exist, and cables go by a step that knows forces at its start.
void LineEngine::checkPlaces() const {
    checkOrder();
    for (size_t i = 0; i < numbers.size(); ++i) {
        if (families[i] < 0) {
            bodyAt(i);
            continue;
        }
        const CableEngine& cables = cable(i);
        if (numbers[i] >= cables.nNodes) refuse(text(placeText(i), ": it has ", cables.nNodes, " nodes"));
        if (cables.integrator != "leapfrog")
            refuse(text("CableEngine ", families[i], ".integrator = '", cables.integrator,
                        "' does not know lines: use 'leapfrog'"));
    }
}

// ---------------------------------------------------------------- one step

// The physics' own arrays, with the attributes in them.
void LineEngine::makeLine() {
    const int spans = static_cast<int>(length.size());
    if (!model || model->spans != spans) {
        ancf_line* made = nullptr;
        if (const ancf_error error = ancf_line_create(&made, spans, ea, ringRadius)) refuse(ancf_error_text(error));
        model.reset(made);
    }
    model->ea = ea;
    model->radius = ringRadius;
    model->rubbed = rubbed;
    model->drawn = drawn;
    model->unsettled = unsettled;
    std::copy(length.begin(), length.end(), model->length);
    std::copy(tension.begin(), tension.end(), model->tension);
    std::copy(slides.begin(), slides.end(), model->slides);
    std::copy(friction.begin(), friction.end(), model->friction);
    for (int end = 0; end < 2; ++end) model->winch[end] = {speed[end], force[end], brake[end], least[end], most[end]};
}

void LineEngine::takeState() {
    length.assign(model->length, model->length + model->spans);
    tension.assign(model->tension, model->tension + model->spans);
    slides.assign(model->slides, model->slides + model->spans + 1);
    rubbed = model->rubbed;
    drawn = model->drawn;
    unsettled = model->unsettled;
}

void LineEngine::findPlaces() {
    const size_t n = numbers.size();
    owner.resize(n);
    at.resize(n);
    for (size_t i = 0; i < n; ++i) {
        Vector3r place;
        if (families[i] < 0) {
            owner[i] = nullptr;
            const State& state = *bodyAt(i).state;
            place = state.pos + state.ori * offsets[i];
        } else {
            owner[i] = i > 0 && families[i - 1] == families[i] ? owner[i - 1] : &cable(i);
            place = owner[i]->placeOfNode(numbers[i]);
        }
        if (!finite(place)) refuse(placeText(i) + " is at no finite position: look at what acts there");
        at[i] = {place[0], place[1], place[2]};
    }
}

namespace {
    const Real (*coordinates(const vector<std::array<Real, 3>>& at))[3] {
        return reinterpret_cast<const Real(*)[3]>(at.data());
    }
} // namespace

// Speeds that are functions of time.
void LineEngine::askWinches() {
    for (size_t end = 0; end < 2; ++end) {
        if (!scripted[end]) continue;
        const Scene& s = theScene();
        const string which = text("speed of end ", end ? -1 : 0);
        if (!speeds.has(static_cast<int>(end)))
            refuse(which + ", a Python function of time, is not saved with a scene: haul() again");
        speed[end] = speeds(static_cast<int>(end), s.time + s.dt, text("LineEngine '", name, "', ", which));
    }
}

Vector3r LineEngine::pullAt(size_t i) const {
    Vector3r pull;
    ancf_line_pull(pull.data(), model.get(), static_cast<int>(i));
    return pull;
}

// Forces on bodies add up exactly in whatever order; what that rounds off goes with those of the next step.
void LineEngine::pullBodies() {
    leftForce.resize(numbers.size(), Vector3r::Zero());
    leftTorque.resize(numbers.size(), Vector3r::Zero());
    for (size_t i = 0; i < numbers.size(); ++i) {
        if (families[i] >= 0) continue;
        const Body& body = bodyAt(i);
        const Vector3r pull = pullAt(i);
        const Left left = addExactly(*scene, body, movedBody(*scene, body), pull + leftForce[i],
                                     (body.state->ori * offsets[i]).cross(pull) + leftTorque[i]);
        leftForce[i] = left.force;
        leftTorque[i] = left.torque;
    }
}

void LineEngine::pullCables() {
    std::map<CableEngine*, vector<std::pair<int, Vector3r>>> forces;
    for (size_t i = 0; i < numbers.size(); ++i)
        if (owner[i]) forces[owner[i]].emplace_back(owner[i]->tied(numbers[i]), pullAt(i));
    for (auto& [cables, list] : forces) cables->pull(this, scene->iter, std::move(list));
}

void LineEngine::noteEnergy() {
    auto& tracker = *scene->energy;
    tracker.add(ancf_line_energy(model.get()), "lineElastic", elasticIx, true);
    tracker.add(model->rubbed - rubbed, "lineFriction", frictionIx, false);
    tracker.add(drawn - model->drawn, "winchWork", workIx, false);
}

bool LineEngine::lookDue() const {
    return checkedIter < 0 || scene->iter < checkedIter || scene->iter >= checkedIter + lookInterval ||
           scene->dt != checkedStep;
}

void LineEngine::action() {
    const StepGuard guard;
    throwLate(*scene);
    needSound();
    if (!(finite(scene->dt) && scene->dt > 0)) refuse(text("O.dt = ", scene->dt, " s: must be finite and above 0"));
    const bool look = lookDue();
    if (look) checkPlaces();
    askWinches();
    findPlaces();
    makeLine();
    ancf_line_step(model.get(), coordinates(at), scene->dt);
    if (look) checkStep();
    if (scene->trackEnergy) noteEnergy();
    for (size_t i = 0; i < flow.size(); ++i) flow[i] = model->flow[i] / scene->dt;
    takeState();
    pullBodies();
    pullCables();
}

// ---------------------------------------------------------------- the step

// What a place of a line moves: a knot, or a body or clump.
std::pair<int, int> LineEngine::moved(const LineEngine& line, size_t i) const {
    const Scene& s = theScene();
    const int family = line.families[i], number = line.numbers[i];
    if (family < 0) return {-1, s.bodies->exists(number) ? movedBody(s, *(*s.bodies)[number]).id : number};
    const CableEngine* cables = findCable(family);
    return {family, cables ? cables->tied(number) : number};
}

// What lines come to several times, this one or others, answers as often.
vector<Real> LineEngine::inverseMasses() const {
    const size_t n = numbers.size();
    vector<Real> inverse(n);
    std::map<std::pair<int, int>, int> visits;
    std::set<const LineEngine*> all(otherLines.begin(), otherLines.end());
    for (const auto& engine : theScene().engines)
        if (const auto* line = dynamic_cast<const LineEngine*>(engine.get()); line && !line->dead) all.insert(line);
    all.insert(this);
    for (const LineEngine* line : all) {
        line->checkLists();
        for (size_t i = 0; i < line->numbers.size(); ++i) ++visits[moved(*line, i)];
    }
    for (size_t i = 0; i < n; ++i) {
        if (owner[i]) {
            inverse[i] = owner[i]->mobilityOfNode(numbers[i]);
        } else {
            const Body& body = movedBody(theScene(), bodyAt(i));
            const Mobility m = mobility(theScene(), body);
            const Vector3r arm = Vector3r(at[i][0], at[i][1], at[i][2]) - body.state->pos;
            inverse[i] = m.inverseMass.maxCoeff() + m.along.squaredNorm() + arm.squaredNorm() * m.inverseInertia.norm();
        }
        inverse[i] *= visits[moved(*this, i)];
    }
    return inverse;
}

// Engines that Python hands over, which are known while they are asked for.
class LineEngine::Handed {
    LineEngine& line;

public:
    Handed(LineEngine& one, const py::object& engines) : line(one) {
        vector<CableEngine*> others;
        vector<const LineEngine*> lines;
        for (py::ssize_t i = 0; i < py::len(engines); ++i) {
            const py::extract<shared_ptr<CableEngine>> cables(engines[i]);
            const py::extract<shared_ptr<LineEngine>> other(engines[i]);
            if (!cables.check() && !other.check())
                throw std::invalid_argument(text("LineEngine: engines[", i, "] must be a CableEngine or a LineEngine"));
            if (cables.check()) others.push_back(cables().get());
            else lines.push_back(other().get());
        }
        line.others.swap(others);
        line.otherLines.swap(lines);
    }
    Handed(const Handed&) = delete;
    Handed& operator=(const Handed&) = delete;
    ~Handed() {
        line.others.clear();
        line.otherLines.clear();
    }
};

void LineEngine::layNow() {
    checkLists();
    findPlaces();
    makeLine();
    ancf_line_lay(model.get(), coordinates(at));
}

Real LineEngine::criticalTimeStep(const py::object& engines) {
    const Handed handed(*this, engines);
    layNow();
    const bool rough = std::any_of(friction.begin(), friction.end(), [](Real f) { return f > 0; });
    const Real share = rough && ringRadius > 0 ? 0 : nearer; // stuck spans are as stiff as they are short
    return safety * 2 / std::sqrt(ancf_line_frequency2(model.get(), inverseMasses().data(), share));
}

// With the cables' own, as their frequencies add up; in sub-steps they are on their own.
void LineEngine::checkStep() {
    const Real dt = scene->dt;
    const Real own = 2 / std::sqrt(ancf_line_frequency2(model.get(), inverseMasses().data(), 1));
    Real limit = own;
    for (const int family : std::set<int>(families.begin(), families.end())) {
        if (family < 0) continue;
        const Real cables = CableEngine::of(*scene, family)->criticalTimeStep();
        if (dt <= cables * (1 + 1e-7)) limit = std::min(limit, 1 / std::hypot(1 / own, safety / cables));
    }
    if (dt <= limit * (1 + 1e-7)) {
        checkedIter = scene->iter;
        checkedStep = dt;
        return;
    }
    const Real nearest = *std::min_element(model->way, model->way + model->spans);
    refuse(text("at iteration ", scene->iter, " the step O.dt = ", dt, " s is above the stable one, ", limit,
                " s, of the line and what it pulls at (its nearest rings are ", nearest,
                " m apart): use O.dt <= ", limit, ", larger rings, or less EA"));
}

// ---------------------------------------------------------------- from Python

vector<Real> LineEngine::ways(const py::object& cables) {
    const Handed handed(*this, cables);
    layNow();
    return vector<Real>(model->way, model->way + model->spans);
}

vector<Vector3r> LineEngine::points() {
    checkLists();
    findPlaces();
    vector<Vector3r> all;
    for (const auto& p : at) all.emplace_back(p[0], p[1], p[2]);
    return all;
}

int LineEngine::endNumber(int end) const {
    if (end != 0 && end != -1)
        throw std::invalid_argument(
            text("LineEngine '", name, "': end = ", end, ": must be 0, the first place, or -1"));
    return end ? 1 : 0;
}

void LineEngine::setWinch(int end, const py::object& newSpeed, Real newForce, Real newBrake, Real newLeast,
                          Real newMost) {
    const int i = endNumber(end);
    const auto before = std::tuple(speed, force, brake, least, most, scripted);
    const bool script = isFunction(newSpeed);
    speed[i] = script ? 0 : static_cast<Real>(py::extract<Real>(newSpeed));
    force[i] = newForce;
    brake[i] = newBrake;
    least[i] = newLeast;
    most[i] = newMost;
    scripted[i] = script;
    try {
        checkLists();
    } catch (...) {
        std::tie(speed, force, brake, least, most, scripted) = before;
        throw;
    }
    speeds.set(i, script ? newSpeed : py::object());
}

string LineEngine::doing(int end) const {
    const int i = endNumber(end);
    checkLists();
    switch (slides[i ? slides.size() - 1 : 0]) {
    case ANCF_DRAWS:
        return speed[i] > 0 ? "draws" : "lets out";
    case ANCF_STRAINS:
        return "strains";
    case ANCF_SLIPS:
        return "slips";
    default:
        if (speed[i] == 0) return "holds";
        if (speed[i] < 0) return "stopped";
        return wholeLength() <= least[i] * (1 + 1e-9) ? "stopped" : "strains";
    }
}

Real LineEngine::elastic() {
    checkLists();
    makeLine();
    return ancf_line_energy(model.get());
}

Real LineEngine::wholeLength() const {
    Real sum = 0;
    for (const Real each : length) sum += each;
    return sum;
}

} // namespace yade
