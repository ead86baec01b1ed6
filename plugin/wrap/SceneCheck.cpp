// SPDX-License-Identifier: GPL-2.0-or-later
#include "SceneCheck.hpp"

#include "CableElement.hpp"
#include "CableEngine.hpp"
#include "Drive.hpp"
#include "HollarsPhys.hpp"
#include "Mobility.hpp"
#include "text.hpp"

#include <core/InteractionLoop.hpp>
#include <lib/factory/ClassFactory.hpp>
#include <pkg/common/Collider.hpp>
#include <pkg/dem/NewtonIntegrator.hpp>

#include <array>
#include <iostream>
#include <map>
#include <tuple>

namespace yade {

namespace {
    const char* const orderText = "the order is ForceResetter, InteractionLoop, CableEngine, NewtonIntegrator";

    template <class T> const T* as(const shared_ptr<Engine>& engine) { return dynamic_cast<const T*>(engine.get()); }

    [[noreturn]] void refuse(const string& why) { throw std::runtime_error(why); }

    // ---- functors: which of them YADE would take

    // Number by which dispatchers know a class.
    int indexOf(const string& className) {
        static std::map<string, int> known;
        const auto found = known.find(className);
        if (found != known.end()) return found->second;
        int index = -1;
        try {
            const auto made = ClassFactory::instance().createShared(className);
            const Factorable* object = made.get();
            if (const auto* shape = dynamic_cast<const Shape*>(object)) index = shape->getClassIndex();
            else if (const auto* material = dynamic_cast<const Material*>(object)) index = material->getClassIndex();
            else if (const auto* geom = dynamic_cast<const IGeom*>(object)) index = geom->getClassIndex();
            else if (const auto* phys = dynamic_cast<const IPhys*>(object)) index = phys->getClassIndex();
        } catch (const std::exception&) { // there is no such class
        }
        return known[className] = index;
    }

    // Generations from an object's class up to another; -1: it does not derive from that.
    int distance(const Indexable& object, int index) {
        if (index < 0) return -1;
        if (object.getClassIndex() == index) return 0;
        for (int depth = 1;; ++depth) {
            const int base = object.getBaseClassIndex(depth);
            if (base < 0) return -1;
            if (base == index) return depth;
        }
    }

    template <class F>
    const F* functorFor(const vector<shared_ptr<F>>& functors, const Indexable& a, const Indexable& b) {
        const F* nearest = nullptr;
        int least = 0;
        for (const auto& f : functors) {
            const int first = indexOf(f->get2DFunctorType1()), second = indexOf(f->get2DFunctorType2());
            for (const auto& [p, q] : {std::pair(&a, &b), std::pair(&b, &a)}) {
                const int da = distance(*p, first), db = distance(*q, second);
                if (da < 0 || db < 0 || (nearest && da + db >= least)) continue;
                nearest = f.get();
                least = da + db;
            }
        }
        return nearest;
    }

    bool boundBy(const Collider& collider, const Shape& shape) {
        if (!collider.boundDispatcher) return false;
        for (const auto& f : collider.boundDispatcher->functors)
            if (distance(shape, indexOf(f->get1DFunctorType1())) >= 0) return true;
        return false;
    }

    // What a functor makes, the last word of its name; null if that is no class of YADE.
    template <class T> shared_ptr<T> madeBy(const Serializable& functor) {
        const string name = functor.getClassName();
        try {
            return YADE_PTR_DYN_CAST<T>(ClassFactory::instance().createShared(name.substr(name.rfind('_') + 1)));
        } catch (const std::exception&) {
            return nullptr;
        }
    }

    // ---- bodies

    bool canMeet(const Body& a, const Body& b) {
        if (!(a.isBounded() && b.isBounded() && a.groupMask & b.groupMask)) return false;
        const bool first = CableElement::of(a), second = CableElement::of(b);
        if (first && second) return false; // their engine finds these
        return first || second || a.isDynamic() || b.isDynamic();
    }
} // namespace

void warn(const string& what) {
    if (!PyGILState_Check()) std::cerr << "ancf WARNING: " << what << std::endl;
    else if (PyErr_WarnEx(PyExc_UserWarning, what.c_str(), 1) < 0) py::throw_error_already_set();
}

string fullName(const Body& body) {
    const CableElement* element = CableElement::of(body);
    return text("body ", body.id, " (", body.shape ? body.shape->getClassName() : "no shape",
                element ? text(" ", element->element) : "", ", ",
                body.material ? body.material->getClassName() : "no material",
                body.material && !body.material->label.empty() ? text(" '", body.material->label, "'") : "", ")");
}

// ---------------------------------------------------------------- engines

uint64_t SceneCheck::print() const {
    uint64_t sum = scene.isPeriodic;
    const auto add = [&](uint64_t value) { sum = 31 * sum + value; };
    const auto addPointer = [&](const void* pointer) { add(reinterpret_cast<uintptr_t>(pointer)); };
    const auto addFunctors = [&](const auto& dispatcher) {
        if (!dispatcher) return;
        for (const auto& f : dispatcher->functors) addPointer(f.get());
    };
    for (const auto& engine : scene.engines) {
        addPointer(engine.get());
        add(engine->dead);
    }
    const KnownEngines& known = knownEngines(scene);
    for (const DriveEngine& each : known.drives) add(each.drive->bodies().size());
    for (const InteractionLoop* loop : known.loops) {
        addFunctors(loop->geomDispatcher);
        addFunctors(loop->physDispatcher);
        addFunctors(loop->lawDispatcher);
    }
    for (const Collider* each : known.colliders) addFunctors(each->boundDispatcher);
    return sum;
}

// Each kind is there and lives, all of one before all of the next.
void SceneCheck::order() const {
    struct Kind {
        const char* name;
        bool (*is)(const shared_ptr<Engine>&);
        const Engine* first;
        size_t begin, end;
    };
    std::array<Kind, 4> kinds {
        Kind {"ForceResetter", [](const auto& e) { return e->getClassName() == "ForceResetter"; }, nullptr, 0, 0},
        Kind {"InteractionLoop", [](const auto& e) { return as<InteractionLoop>(e) != nullptr; }, nullptr, 0, 0},
        Kind {"CableEngine", [](const auto& e) { return as<CableEngine>(e) != nullptr; }, nullptr, 0, 0},
        Kind {"NewtonIntegrator", [](const auto& e) { return as<NewtonIntegrator>(e) != nullptr; }, nullptr, 0, 0}};
    for (Kind& kind : kinds) {
        bool dead = false;
        for (size_t i = 0; i < scene.engines.size(); ++i) {
            const auto& engine = scene.engines[i];
            if (!kind.is(engine)) continue;
            dead = dead || engine->dead;
            if (engine->dead) continue;
            if (kind.first && !as<CableEngine>(engine))
                refuse(text("O.engines has two live ", kind.name, "s, at ", kind.begin, " and ", i,
                            ": each would do the whole work; take one out, or switch it off (dead=True)"));
            if (!kind.first) kind.begin = i;
            kind.first = engine.get();
            kind.end = i;
        }
        if (!kind.first && dead) refuse(text("the ", kind.name, " in O.engines is dead: set dead=False; ", orderText));
        if (!kind.first) refuse(text("O.engines has no ", kind.name, ": add one; ", orderText));
    }
    for (size_t i = 1; i < kinds.size(); ++i)
        if (kinds[i - 1].end > kinds[i].begin)
            refuse(text("O.engines: ", kinds[i - 1].name, " comes after ", kinds[i].name, "; ", orderText));
}

void SceneCheck::once() const {
    for (size_t i = 0; i < scene.engines.size(); ++i)
        for (size_t j = 0; j < i; ++j)
            if (scene.engines[i] == scene.engines[j])
                refuse(text("O.engines holds the same ", scene.engines[i]->getClassName(), " at ", j, " and at ", i,
                            ": it would act twice in each step; take one of them out"));
            else if (const auto* a = as<CableEngine>(scene.engines[i]), *b = as<CableEngine>(scene.engines[j]);
                     a && b && a->family == b->family)
                refuse(text("O.engines holds two CableEngines of family ", a->family, ", at ", j, " and at ", i,
                            ": both would move the same cables; take one of them out"));
}

// Bodies are moved by one drive, which stands where CableEngines know its forces and NewtonIntegrator its speeds.
void SceneCheck::drives() const {
    size_t cable = 0, newton = scene.engines.size();
    for (size_t i = 0; i < scene.engines.size(); ++i) {
        if (as<CableEngine>(scene.engines[i])) cable = i;
        if (as<NewtonIntegrator>(scene.engines[i]) && !scene.engines[i]->dead) newton = std::min(newton, i);
    }
    std::map<std::pair<string, Body::id_t>, size_t> moved;
    for (size_t i = 0; i < scene.engines.size(); ++i) {
        const Engine& engine = *scene.engines[i];
        const auto* drive = dynamic_cast<const Drive*>(&engine);
        if (!drive || engine.dead || drive->bodies().empty()) continue;
        if (i < cable || i > newton)
            refuse(text("O.engines: ", engine.getClassName(), " stands ",
                        i < cable ? "before CableEngine" : "after NewtonIntegrator",
                        ": must stand after CableEngine, which gives it the forces, and before NewtonIntegrator"));
        for (const Body::id_t id : drive->bodies()) {
            const auto [other, isNew] = moved.insert({{engine.getClassName(), id}, i});
            if (!isNew)
                refuse(text("body ", id, " is driven by two ", engine.getClassName(), "s, at ", other->second,
                            " and at ", i, " of O.engines: take it out of one of them"));
        }
    }
}

void SceneCheck::collider() const {
    bool cables = false, any = false;
    for (const auto& body : *scene.bodies) cables = cables || CableElement::of(*body);
    size_t loop = 0;
    for (size_t i = 0; i < scene.engines.size(); ++i)
        if (as<InteractionLoop>(scene.engines[i]) && !scene.engines[i]->dead) loop = i;
    for (size_t i = 0; i < scene.engines.size(); ++i) {
        const auto* collider = as<Collider>(scene.engines[i]);
        if (!collider) continue;
        if (!collider->dead && i > loop) refuse("O.engines: the collider comes after InteractionLoop; put it before");
        any = any || !collider->dead;
        if (cables && !(collider->avoidSelfInteractionMask & CableElement::allHave))
            warn(text(collider->getClassName(), ".avoidSelfInteractionMask = ", collider->avoidSelfInteractionMask,
                      ": every pair of cable elements that are near will be looked at in every step, for nothing; add ",
                      CableElement::allHave, ", or use ancf.engines()"));
    }
    if (cables && !any)
        refuse("O.engines has no live collider: cables would pass through everything; add an InsertionSortCollider "
               "before InteractionLoop, or use ancf.engines()");
}

// Whether a body that NewtonIntegrator moves can meet a cable, or hangs on one.
bool SceneCheck::cablesFeelBodies() const {
    mask_t masks = 0;
    for (const auto& engine : scene.engines)
        if (const auto* cable = dynamic_cast<const CableEngine*>(engine.get()); cable && !cable->carryIds.empty())
            return true;
    for (const auto& body : *scene.bodies)
        if (body && CableElement::of(*body)) masks |= body->groupMask;
    for (const auto& body : *scene.bodies)
        if (body && body->groupMask & masks && !CableElement::of(*body) && mobility(scene, *body).movable())
            return true;
    return false;
}

void SceneCheck::engines() const {
    if (scene.isPeriodic)
        throw std::invalid_argument("O.periodic = True: cables do not know periodic cells; set it to False");
    once();
    order();
    drives();
    collider();
    if (const NewtonIntegrator* newton = newtonOf(scene); newton && newton->damping != 0 && cablesFeelBodies())
        warn(text("NewtonIntegrator.damping = ", newton->damping,
                  ": bodies lose momentum without a cause; set it to 0"));
}

// ---------------------------------------------------------------- functors

void SceneCheck::pair(const InteractionLoop& loop, const Body& a, const Body& b) const {
    const string both = text(fullName(a), " and ", fullName(b));
    const auto* geom = functorFor(loop.geomDispatcher->functors, *a.shape, *b.shape);
    const auto* phys =
        a.material && b.material ? functorFor(loop.physDispatcher->functors, *a.material, *b.material) : nullptr;
    if (!geom || !phys) {
        const string why = text(both, " can meet, but InteractionLoop has no ", geom ? "Ip2" : "Ig2",
                                " functor for their ", geom ? "materials" : "shapes",
                                ": they would pass through each other; use ancf.engines(), or separate them by "
                                "groupMask");
        if (CableElement::of(a) || CableElement::of(b)) refuse(why);
        return warn(why);
    }
    const auto geometry = madeBy<IGeom>(*geom);
    const auto physics = madeBy<IPhys>(*phys);
    if (!geometry || !physics) return;
    for (const auto& law : loop.lawDispatcher->functors)
        if (distance(*geometry, indexOf(law->get2DFunctorType1())) >= 0 &&
            distance(*physics, indexOf(law->get2DFunctorType2())) >= 0)
            return;
    refuse(text(both, " can meet, but InteractionLoop has no Law2 functor for ", geometry->getClassName(), " and ",
                physics->getClassName(), ": YADE would end at their first contact; add one, or use ancf.engines()"));
}

void SceneCheck::functors() const {
    struct Kind {
        const Body* body;
        int number;
        bool oneClump; // all of them are members of the same, and never meet
    };
    std::map<std::tuple<string, string, mask_t, bool>, Kind> kindOf;
    for (const auto& body : *scene.bodies) {
        if (!body->shape || body->isClump()) continue;
        if (body->shape->getClassName() == "Subdomain") continue; // a box of yade.mpy, which nothing touches
        const bool moves = CableElement::of(*body) || body->isDynamic();
        const string material = body->material ? body->material->getClassName() : "";
        Kind& kind =
            kindOf.insert({{body->shape->getClassName(), material, body->groupMask, moves}, {body.get(), 0, true}})
                .first->second;
        ++kind.number;
        kind.oneClump = kind.oneClump && body->isClumpMember() && body->clumpId == kind.body->clumpId;
    }
    vector<Kind> kinds;
    for (const auto& [key, kind] : kindOf) kinds.push_back(kind);
    std::sort(kinds.begin(), kinds.end(), [](const Kind& a, const Kind& b) { return a.body->id < b.body->id; });
    const auto& colliders = knownEngines(scene).colliders;
    const InteractionLoop* loop = nullptr;
    for (const InteractionLoop* each : knownEngines(scene).loops)
        if (!each->dead) loop = each;
    for (const Kind& kind : kinds) {
        const Body& body = *kind.body;
        const auto bounds = [&](const Collider* c) { return boundBy(*c, *body.shape); };
        if (body.isBounded() && !colliders.empty() && std::none_of(colliders.begin(), colliders.end(), bounds))
            refuse(text(fullName(body), ": the collider has no Bo1 functor for a ", body.shape->getClassName(),
                        "; add Bo1_", body.shape->getClassName(), "_Aabb()"));
    }
    const auto together = [](const Kind& a, const Kind& b) {
        return a.oneClump && b.oneClump && a.body->clumpId == b.body->clumpId;
    };
    for (size_t i = 0; loop && i < kinds.size(); ++i)
        for (size_t j = i; j < kinds.size(); ++j)
            if ((i != j || kinds[i].number > 1) && !together(kinds[i], kinds[j]) &&
                canMeet(*kinds[i].body, *kinds[j].body))
                pair(*loop, *kinds[i].body, *kinds[j].body);
    if (!loop) return;
    for (const auto& functor : loop->lawDispatcher->functors) {
        const auto* law = dynamic_cast<const Law2_ScGeom_HollarsPhys_Hollars*>(functor.get());
        if (!law) continue;
        for (const auto& engine : scene.engines) {
            const auto* cables = as<CableEngine>(engine);
            const auto same = [&](const char* name, const string& its, const string& mine) {
                if (mine != its)
                    warn(text("Law2_ScGeom_HollarsPhys_Hollars.", name, " = '", its, "', but CableEngine.", name,
                              " = '", mine,
                              "': the former does not reach contacts of cables; set both, or use "
                              "ancf.engines(contact=...)"));
            };
            if (!cables) continue;
            same("normal", law->normal, cables->normal);
            same("friction", law->friction, cables->friction);
        }
    }
}

} // namespace yade
