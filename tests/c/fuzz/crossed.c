// What finds contacts of cables with cables: boxes, pairs of segments, contacts.
#include "../finder.h"
#include "fuzz.h"

enum { KINDS = 2, CONTACTS_MOST = 6 * 6 * 64 };

// Boxes set: elements that touch now are among the pairs that may meet.
static bool look(finder* s, fuzz* f, const built* b, const ancf_cover* cover, double step) {
    const ancf_model* m = b->m;
    ancf_boxes_plan(s->boxes, m, step, 1 + pick(f, 100), magnitude(f, 1e-6, 1e-2));
    if (ancf_boxes_set(s->boxes, m) < 0 || ancf_apart_set(s->apart, s->boxes, m) < 0) return false;
    int n;
    const ancf_meeting* meeting = ancf_boxes_meetings(s->boxes, &n);
    for (int k = 0; k < n; ++k) {
        need(meeting[k].first >= 0 && meeting[k].first < meeting[k].second && meeting[k].second < m->n_elements);
        need(k == 0 || meeting[k].first > meeting[k - 1].first ||
             (meeting[k].first == meeting[k - 1].first && meeting[k].second > meeting[k - 1].second));
    }
    for (int e = 0; e < m->n_elements; ++e) need(!(ancf_boxes_room(s->boxes, e) < 0.0) && ancf_boxes_box(s->boxes, e));
    if (f->chance > 0.0) return true;
    need(ancf_boxes_hold(s->boxes, m));
    for (int e = 0; e < m->n_elements; ++e)
        for (int g = e + 1; g < m->n_elements; ++g) {
            const ancf_cover *p = &cover[e], *q = &cover[g];
            if (p->radius == 0.0 || q->radius == 0.0 || !(p->mask & q->mask)) continue;
            if (p->structure == q->structure && !(p->own && q->own)) continue;
            bool joined = false;
            for (int k = 0; k < 4; ++k) joined = joined || b->ends[2 * e + k / 2] == b->ends[2 * g + k % 2];
            if (joined) continue;
            ancf_cubic first, second;
            ancf_nearest_pair found[64];
            ancf_cover_cubic(&first, m, m->x, e);
            ancf_cover_cubic(&second, m, m->x, g);
            if (ancf_nearest_cubic(found, &first, p->segments, p->radius, &second, q->radius, 0.0) == 0) continue;
            bool listed = false;
            for (int k = 0; k < n; ++k) listed = listed || (meeting[k].first == e && meeting[k].second == g);
            need(listed);
        }
    return true;
}

// after: room for two fields.
static bool step_on(finder* s, fuzz* f, built* b, const ancf_cover* cover, const ancf_laws* laws, double step,
                    ancf_memory* memory, int* kept, double* after) {
    ancf_model* m = b->m;
    const ancf_time time = {step, step};
    ancf_table_clear(s->table);
    ancf_predict(m, &time);
    ancf_motion_follow(s->motion, m, step);
    const int n = ancf_cross_add(s->table, s->apart, cover, m, laws, KINDS, step, memory, *kept);
    if (n < 0) return false;
    need(n == ancf_table_contacts(s->table));
    for (int i = 0; i < n; ++i) {
        const ancf_contact* c = ancf_table_contact(s->table, i);
        need(c->key[0] >= 0 && c->key[0] < c->key[1] && c->key[1] < m->n_elements);
        need(c->key[2] >= 0 && c->key[2] < cover[c->key[0]].segments);
        if (f->chance == 0.0) need(isfinite(c->gap) && is_unit(c->normal));
    }
    if (ancf_table_prepare(s->table, m, m->free)) return false;
    ancf_table_accelerate(s->table, m, m->a);
    int stiffest;
    double left;
    const int needed = ancf_table_substeps(s->table, step, &stiffest);
    ancf_table_press(s->table, step, needed < 50 ? needed : 50);
    ancf_table_rub(s->table, step, &left);
    const size_t size = 3 * (size_t)b->stride;
    double* shift = after + size;
    memset(shift, 0, size * sizeof *shift);
    memcpy(after, m->free, size * sizeof *after);
    ancf_table_apply(s->table, m, step, after, shift);
    ancf_table_end(s->table, step);
    *kept = n < CONTACTS_MOST ? ancf_cross_keep(memory, s->table, 0, n) : 0;
    ancf_correct(m, &time, after, shift);
    return true;
}

void fuzz_crossed(fuzz* f) {
    built b;
    if (!any_model(&b, f)) return;
    ancf_cover* cover = any_cover(f, b.m, by_chance(f, 0.1) ? 64 : 6, KINDS);
    ancf_laws laws[KINDS * KINDS];
    for (int i = 0; i < KINDS * KINDS; ++i) laws[i] = (ancf_laws) {good_normal_law(f), good_friction_law(f)};
    ancf_memory* memory = calloc(CONTACTS_MOST, sizeof *memory);
    int kept = 0;
    const double step = any_step(f, b.m);
    double* after = calloc(6 * (size_t)b.stride, sizeof *after);
    spoil(f, &b);
    if (by_chance(f, 0.1)) fuzz_fail_allocation(1 + pick(f, 80));
    finder s;
    if (finder_start(&s, b.m, cover) && look(&s, f, &b, cover, step))
        for (int i = 0, steps = 1 + pick(f, 3); i < steps; ++i)
            if (!step_on(&s, f, &b, cover, laws, step, memory, &kept, after)) break;
    finder_end(&s);
    fuzz_fail_allocation(0);
    free(after);
    free(memory);
    free(cover);
    build_free(&b);
}
