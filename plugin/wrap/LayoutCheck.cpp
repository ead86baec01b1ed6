// SPDX-License-Identifier: GPL-2.0-or-later
#include "LayoutCheck.hpp"

#include <core/Clump.hpp>
#include <core/Dispatching.hpp>
#include <core/InteractionLoop.hpp>
#include <core/Scene.hpp>
#include <pkg/common/Box.hpp>
#include <pkg/common/ElastMat.hpp>
#include <pkg/common/Facet.hpp>
#include <pkg/common/InsertionSortCollider.hpp>
#include <pkg/common/OpenGLRenderer.hpp>
#include <pkg/common/Sphere.hpp>
#include <pkg/common/Wall.hpp>
#include <pkg/dem/FrictPhys.hpp>
#include <pkg/dem/NewtonIntegrator.hpp>
#include <pkg/dem/ScGeom.hpp>

#include <cstring>
#include <dlfcn.h>
#include <functional>
#include <limits>
#include <link.h>
#include <malloc.h>
#include <memory>
#include <sys/uio.h>
#include <unistd.h>

using namespace yade;

namespace ancf {

namespace {

    // A number that our headers imply, and a question to the running YADE whether it is right.
    struct Fact {
        std::string name;
        long ours;
        std::function<bool(long)> holds;
    };
    using Facts = std::vector<Fact>;

    // An object that YADE itself made.
    shared_ptr<Serializable> make(const std::string& className) {
        return YADE_PTR_DYN_CAST<Serializable>(ClassFactory::instance().createShared(className));
    }

    char* startOf(const shared_ptr<Serializable>& object) {
        return static_cast<char*>(dynamic_cast<void*>(object.get()));
    }

    // ---- sizes

    constexpr int attempts = 32;

    // What the allocator gives for so many bytes. Now and then it hands out a little more: the least of many is exact,
    // if none is given back in between.
    size_t usableSize(long bytes) {
        std::vector<std::unique_ptr<void, decltype(&std::free)>> kept;
        size_t least = std::numeric_limits<size_t>::max();
        for (int i = 0; i < attempts; ++i) {
            kept.emplace_back(std::malloc(static_cast<size_t>(bytes)), &std::free);
            least = std::min(least, malloc_usable_size(kept.back().get()));
        }
        return least;
    }

    bool sizeHolds(const std::string& className, long bytes) {
        const size_t expected = usableSize(bytes);
        std::vector<shared_ptr<Serializable>> kept;
        for (int i = 0; i < attempts; ++i) {
            kept.push_back(make(className));
            const size_t actual = malloc_usable_size(startOf(kept.back()));
            if (actual <= expected) return actual == expected;
        }
        return false;
    }

    template <class C> void addSize(Facts& facts, const std::string& className) {
        facts.push_back({"sizeof " + className, static_cast<long>(sizeof(C)),
                         [className](long bytes) { return sizeHolds(className, bytes); }});
    }

    // ---- attributes: set through Python's door, read at our offset

    template <class T> bool equalAt(const char* at, const T& value) { return std::memcmp(at, &value, sizeof(T)) == 0; }

    // A short string lies inside the object; nothing is followed that might not be a pointer.
    bool equalAt(const char* at, const std::string& value) {
        const char* data;
        size_t length;
        std::memcpy(&data, at, sizeof data);
        std::memcpy(&length, at + 8, sizeof length);
        return data == at + 16 && length == value.size() && std::memcmp(data, value.data(), length) == 0;
    }

    template <class T> bool equalAt(const char* at, const shared_ptr<T>& value) {
        const T* plain = value.get();
        return std::memcmp(at, &plain, sizeof plain) == 0;
    }

    bool safeRead(void* to, const void* from, size_t bytes) {
        const iovec local {to, bytes}, remote {const_cast<void*>(from), bytes};
        return process_vm_readv(getpid(), &local, 1, &remote, 1, 0) == static_cast<ssize_t>(bytes);
    }

    // A list of one.
    template <class T> bool equalAt(const char* at, const std::vector<shared_ptr<T>>& value) {
        const char* range[2];
        const T* first;
        std::memcpy(range, at, sizeof range);
        return range[1] - range[0] == sizeof(value[0]) && safeRead(&first, range[0], sizeof first) &&
               first == value[0].get();
    }

    template <class T>
    bool attributeHolds(const std::string& className, const std::string& attribute, const T& value, long offset) {
        const auto object = make(className);
        object->pySetAttr(attribute, py::object(value));
        const char* start = startOf(object);
        const long room =
            static_cast<long>(malloc_usable_size(const_cast<char*>(start))) - static_cast<long>(sizeof(T));
        return offset >= 0 && offset <= room && equalAt(start + offset, value);
    }

    template <class C, class T> using Member = T C::*;

    template <class C, class T> long offsetOf(Member<C, T> member) {
        alignas(C) static char place[sizeof(C)]; // only its address is used
        const C* object = reinterpret_cast<const C*>(place);
        return reinterpret_cast<const char*>(&(object->*member)) - place;
    }

    template <class C, class T, class V> void addAttribute(Facts& facts, const std::string& className,
                                                           const std::string& attribute, Member<C, T> member, V value) {
        const T typed(value);
        facts.push_back({className + "." + attribute, offsetOf(member),
                         [=](long offset) { return attributeHolds<T>(className, attribute, typed, offset); }});
    }

    template <class C, class F> void addFunctors(Facts& facts, const std::string& className,
                                                 Member<C, std::vector<shared_ptr<F>>> member,
                                                 const std::string& functor) {
        facts.push_back({className + ".functors", offsetOf<C>(member), [=](long offset) {
                             const std::vector<shared_ptr<F>> one {YADE_PTR_DYN_CAST<F>(make(functor))};
                             return attributeHolds(className, "functors", one, offset);
                         }});
    }

    // ---- vtables

    std::string symbolAt(const void* address) {
        Dl_info info;
        return dladdr(address, &info) && info.dli_sname && info.dli_saddr == address ? info.dli_sname : "";
    }

    void** vtableAt(const char* subobject) {
        void** table;
        std::memcpy(&table, subobject, sizeof table);
        return table;
    }

    bool vtableSizeHolds(const std::string& className, long bytes) {
        const auto object = make(className);
        Dl_info info;
        ElfW(Sym)* symbol = nullptr;
        void* start = vtableAt(startOf(object)) - 2;
        if (!dladdr1(start, &info, reinterpret_cast<void**>(&symbol), RTLD_DL_SYMENT) || !symbol) return false;
        return info.dli_saddr == start && static_cast<long>(symbol->st_size) == bytes;
    }

    void addVtable(Facts& facts, const std::string& className, long bytes) {
        facts.push_back({"vtable " + className, bytes, [className](long n) { return vtableSizeHolds(className, n); }});
    }

    // What the compiler makes of &C::function for a virtual function: where to look it up.
    struct SlotPointer {
        long place; // 1 + 8 slot
        long adjustment;
    };

    template <class F> void addSlot(Facts& facts, const std::string& className, const std::string& function, F pointer,
                                    std::string symbol) {
        SlotPointer at;
        static_assert(sizeof at == sizeof pointer);
        std::memcpy(&at, &pointer, sizeof at);
        const long adjustment = at.adjustment;
        facts.push_back({"slot " + className + "::" + function, (at.place - 1) / 8, [=](long slot) {
                             const auto object = make(className);
                             return symbolAt(vtableAt(startOf(object) + adjustment)[slot]) == symbol;
                         }});
    }

    // ---- containers of the scene: the pointer at our offset must lead to an object with the right vtable

    bool pointsTo(const std::string& className, const std::string& vtableSymbol, long offset) {
        const auto object = make(className);
        const char* start = startOf(object);
        if (offset < 0 || offset + 8 > static_cast<long>(malloc_usable_size(const_cast<char*>(start)))) return false;
        void* target;
        void** table;
        std::memcpy(&target, start + offset, sizeof target);
        return safeRead(&table, target, sizeof table) && symbolAt(table - 2) == vtableSymbol;
    }

    template <class T> void addPointer(Facts& facts, const std::string& member, Member<Scene, T> pointer,
                                       const std::string& vtableSymbol) {
        facts.push_back({"Scene." + member, offsetOf(pointer),
                         [=](long offset) { return pointsTo("Scene", vtableSymbol, offset); }});
    }

    // ---- the facts

    void addSizes(Facts& f) {
        addSize<Shape>(f, "Shape");
        addSize<Sphere>(f, "Sphere");
        addSize<Box>(f, "Box");
        addSize<Facet>(f, "Facet");
        addSize<Clump>(f, "Clump");
        addSize<State>(f, "State");
        addSize<ElastMat>(f, "ElastMat");
        addSize<FrictMat>(f, "FrictMat");
        addSize<Aabb>(f, "Aabb");
        addSize<Body>(f, "Body");
        addSize<Interaction>(f, "Interaction");
        addSize<ScGeom>(f, "ScGeom");
        addSize<NormShearPhys>(f, "NormShearPhys");
        addSize<FrictPhys>(f, "FrictPhys");
        addSize<GlobalEngine>(f, "GlobalEngine");
        addSize<InteractionLoop>(f, "InteractionLoop");
        addSize<InsertionSortCollider>(f, "InsertionSortCollider");
        addSize<NewtonIntegrator>(f, "NewtonIntegrator");
        addSize<LawFunctor>(f, "LawFunctor");
        addSize<IPhysFunctor>(f, "IPhysFunctor");
        addSize<IGeomFunctor>(f, "IGeomFunctor");
        addSize<BoundFunctor>(f, "BoundFunctor");
        addSize<Cell>(f, "Cell");
        addSize<Scene>(f, "Scene");
    }

    void addBodyAttributes(Facts& f) {
        const Vector3r v(1.25, -2.5, 3.75);
        addAttribute(f, "Shape", "color", &Shape::color, v);
        addAttribute(f, "Shape", "wire", &Shape::wire, true);
        addAttribute(f, "Shape", "highlight", &Shape::highlight, true);
        addAttribute(f, "Sphere", "radius", &Sphere::radius, 1.625);
        addAttribute(f, "Box", "extents", &Box::extents, v);
        addAttribute(f, "Facet", "normal", &Facet::normal, v);
        addAttribute(f, "Facet", "area", &Facet::area, 1.625);
        addAttribute(f, "Wall", "axis", &Wall::axis, 77);
        addAttribute(f, "State", "vel", &State::vel, v);
        addAttribute(f, "State", "mass", &State::mass, 1.625);
        addAttribute(f, "State", "angVel", &State::angVel, v);
        addAttribute(f, "State", "angMom", &State::angMom, v);
        addAttribute(f, "State", "inertia", &State::inertia, v);
        addAttribute(f, "State", "refPos", &State::refPos, v);
        addAttribute(f, "State", "blockedDOFs", &State::blockedDOFs, 37u);
        addAttribute(f, "State", "densityScaling", &State::densityScaling, 1.625);
        addAttribute(f, "FrictMat", "label", &FrictMat::label, "short");
        addAttribute(f, "FrictMat", "density", &FrictMat::density, 1.625);
        addAttribute(f, "FrictMat", "young", &FrictMat::young, 2.625);
        addAttribute(f, "FrictMat", "poisson", &FrictMat::poisson, 3.625);
        addAttribute(f, "FrictMat", "frictionAngle", &FrictMat::frictionAngle, 4.625);
        addAttribute(f, "Aabb", "sweepLength", &Aabb::sweepLength, 1.625);
        addAttribute(f, "Aabb", "min", &Aabb::min, v);
        addAttribute(f, "Aabb", "max", &Aabb::max, v);
        addAttribute(f, "Body", "id", &Body::id, 77);
        addAttribute(f, "Body", "groupMask", &Body::groupMask, 77);
        addAttribute(f, "Body", "flags", &Body::flags, 77);
        addAttribute(f, "Body", "material", &Body::material, YADE_PTR_DYN_CAST<Material>(make("FrictMat")));
        addAttribute(f, "Body", "state", &Body::state, YADE_PTR_DYN_CAST<State>(make("State")));
        addAttribute(f, "Body", "shape", &Body::shape, YADE_PTR_DYN_CAST<Shape>(make("Sphere")));
        addAttribute(f, "Body", "bound", &Body::bound, YADE_PTR_DYN_CAST<Bound>(make("Aabb")));
        addAttribute(f, "Body", "clumpId", &Body::clumpId, 77);
        addAttribute(f, "Body", "timeBorn", &Body::timeBorn, 1.625);
    }

    void addContactAttributes(Facts& f) {
        const Vector3r v(1.25, -2.5, 3.75);
        addAttribute(f, "Interaction", "id1", &Interaction::id1, 77);
        addAttribute(f, "Interaction", "id2", &Interaction::id2, 77);
        addAttribute(f, "Interaction", "iterMadeReal", &Interaction::iterMadeReal, 77L);
        addAttribute(f, "Interaction", "geom", &Interaction::geom, YADE_PTR_DYN_CAST<IGeom>(make("ScGeom")));
        addAttribute(f, "Interaction", "phys", &Interaction::phys, YADE_PTR_DYN_CAST<IPhys>(make("FrictPhys")));
        addAttribute(f, "Interaction", "cellDist", &Interaction::cellDist, Vector3i(7, 8, 9));
        addAttribute(f, "ScGeom", "normal", &ScGeom::normal, v);
        addAttribute(f, "ScGeom", "contactPoint", &ScGeom::contactPoint, v);
        addAttribute(f, "ScGeom", "refR1", &ScGeom::refR1, 1.625);
        addAttribute(f, "ScGeom", "refR2", &ScGeom::refR2, 1.625);
        addAttribute(f, "ScGeom", "penetrationDepth", &ScGeom::penetrationDepth, 1.625);
        addAttribute(f, "ScGeom", "shearInc", &ScGeom::shearInc, v);
        addAttribute(f, "FrictPhys", "kn", &FrictPhys::kn, 1.625);
        addAttribute(f, "FrictPhys", "normalForce", &FrictPhys::normalForce, v);
        addAttribute(f, "FrictPhys", "ks", &FrictPhys::ks, 1.625);
        addAttribute(f, "FrictPhys", "shearForce", &FrictPhys::shearForce, v);
        addAttribute(f, "FrictPhys", "tangensOfFrictionAngle", &FrictPhys::tangensOfFrictionAngle, 1.625);
    }

    void addEngineAttributes(Facts& f) {
        const Vector3r v(1.25, -2.5, 3.75);
        addAttribute(f, "GlobalEngine", "dead", &GlobalEngine::dead, true);
        addAttribute(f, "GlobalEngine", "ompThreads", &GlobalEngine::ompThreads, 77);
        addAttribute(f, "GlobalEngine", "label", &GlobalEngine::label, "short");
        addAttribute(f, "LawFunctor", "label", &LawFunctor::label, "short");
        addAttribute(f, "InteractionLoop", "loopOnSortedInteractions", &InteractionLoop::loopOnSortedInteractions,
                     true);
        addFunctors(f, "BoundDispatcher", &BoundDispatcher::functors, "Bo1_Sphere_Aabb");
        addFunctors(f, "IGeomDispatcher", &IGeomDispatcher::functors, "Ig2_Sphere_Sphere_ScGeom");
        addFunctors(f, "IPhysDispatcher", &IPhysDispatcher::functors, "Ip2_FrictMat_FrictMat_FrictPhys");
        addFunctors(f, "LawDispatcher", &LawDispatcher::functors, "Law2_ScGeom_FrictPhys_CundallStrack");
        addAttribute(f, "InsertionSortCollider", "avoidSelfInteractionMask",
                     &InsertionSortCollider::avoidSelfInteractionMask, 77);
        addAttribute(f, "InsertionSortCollider", "verletDist", &InsertionSortCollider::verletDist, 1.625);
        addAttribute(f, "InsertionSortCollider", "doSort", &InsertionSortCollider::doSort, true);
        addAttribute(f, "NewtonIntegrator", "damping", &NewtonIntegrator::damping, 1.625);
        addAttribute(f, "NewtonIntegrator", "gravity", &NewtonIntegrator::gravity, v);
        addAttribute(f, "NewtonIntegrator", "maxVelocitySq", &NewtonIntegrator::maxVelocitySq, 1.625);
        addAttribute(f, "NewtonIntegrator", "mask", &NewtonIntegrator::mask, 77);
        addAttribute(f, "Scene", "dt", &Scene::dt, 1.625);
        addAttribute(f, "Scene", "iter", &Scene::iter, 77L);
        addAttribute(f, "Scene", "time", &Scene::time, 1.625);
        addAttribute(f, "Scene", "isPeriodic", &Scene::isPeriodic, true);
        addAttribute(f, "Scene", "trackEnergy", &Scene::trackEnergy, true);
        addAttribute(f, "Scene", "doSort", &Scene::doSort, true);
        addPointer(f, "bodies", &Scene::bodies, "_ZTVN4yade13BodyContainerE");
        addPointer(f, "interactions", &Scene::interactions, "_ZTVN4yade20InteractionContainerE");
        addPointer(f, "energy", &Scene::energy, "_ZTVN4yade13EnergyTrackerE");
        addAttribute(f, "OpenGLRenderer", "dispScale", &OpenGLRenderer::dispScale, v); // behind the tables
        addAttribute(f, "GlExtraDrawer", "dead", &GlExtraDrawer::dead, true);
        addPointer(f, "cell", &Scene::cell, "_ZTVN4yade4CellE");
    }

    void addVtables(Facts& f) {
        addVtable(f, "GlobalEngine", 128);
        addVtable(f, "Sphere", 224);
        addVtable(f, "Shape", 224);
        addVtable(f, "ElastMat", 240);
        addVtable(f, "FrictMat", 240);
        addVtable(f, "NormShearPhys", 224);
        addVtable(f, "ScGeom", 224);
        addVtable(f, "State", 224);
        addVtable(f, "Body", 120);
        addVtable(f, "LawFunctor", 288);
        addVtable(f, "IPhysFunctor", 288);
        addVtable(f, "IGeomFunctor", 296);
        addVtable(f, "BoundFunctor", 280);
        addVtable(f, "GlShapeFunctor", 296);
        addVtable(f, "GlExtraDrawer", 120);

        addSlot(f, "Engine", "isActivated", &Engine::isActivated, "_ZN4yade6Engine11isActivatedEv");
        addSlot(f, "Engine", "action", &Engine::action, "_ZN4yade6Engine6actionEv");
        addSlot(f, "NewtonIntegrator", "callPostLoad", &NewtonIntegrator::callPostLoad,
                "_ZN4yade16NewtonIntegrator12callPostLoadEv");
        addSlot(f, "Sphere", "getClassIndex", &Sphere::getClassIndex, "_ZNK4yade6Sphere13getClassIndexEv");
        addSlot(f, "FrictMat", "getClassIndex", &FrictMat::getClassIndex, "_ZNK4yade8FrictMat13getClassIndexEv");
        addSlot(f, "FrictPhys", "getBaseClassIndex", &FrictPhys::getBaseClassIndex,
                "_ZNK4yade9FrictPhys17getBaseClassIndexEi");
        using LawGo = bool (LawFunctor::*)(shared_ptr<IGeom>&, shared_ptr<IPhys>&, Interaction*);
        addSlot(f, "Law2_ScGeom_FrictPhys_CundallStrack", "go", static_cast<LawGo>(&LawFunctor::go),
                "_ZThn80_N4yade35Law2_ScGeom_FrictPhys_CundallStrack2goERN5boost10shared_ptrINS_5IGeomEEERNS2_INS_"
                "5IPhysEEEPNS_11InteractionE");
        addSlot(f, "Law2_ScGeom_FrictPhys_CundallStrack", "get2DFunctorType1", &LawFunctor::get2DFunctorType1,
                "_ZNK4yade35Law2_ScGeom_FrictPhys_CundallStrack17get2DFunctorType1B5cxx11Ev");
    }

    Facts allFacts() {
        Facts facts;
        addSizes(facts);
        addVtables(facts);
        addBodyAttributes(facts);
        addContactAttributes(facts);
        addEngineAttributes(facts);
        return facts;
    }

    std::string mismatchText(const std::string& name, long number) {
        return "ancf does not fit this YADE: " + name + " is not " + std::to_string(number) +
               " as in YADE " ANCF_YADE_NAME ", for which it was built";
    }

} // namespace

int checkLayout(const std::map<std::string, long>& overrides) {
    Facts facts = allFacts();
    for (const auto& [name, number] : overrides) {
        bool known = false;
        for (Fact& fact : facts)
            if (fact.name == name) {
                fact.ours = number;
                known = true;
            }
        if (!known) throw std::invalid_argument("no layout fact is called " + name);
    }
    for (const Fact& fact : facts)
        if (!fact.holds(fact.ours)) throw LayoutMismatch(mismatchText(fact.name, fact.ours));
    return static_cast<int>(facts.size());
}

} // namespace ancf
