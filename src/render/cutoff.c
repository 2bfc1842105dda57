/* The brightest thing that a ray can meet: the sky, a lamp that is seen, what emits, the fog, or a white surface that
 * gets all the light of all lights as if each were at the distance where it has its own colour. Closer to a light that
 * fades it may be brighter: the bound is one for scenes as they are, not for all that can be. */
#include "render/cutoff.h"

#include "math/elementary.h"

static double largest(struct vec3 c) {
    double max = c.x > c.y ? c.x : c.y;
    return c.z > max ? c.z : max;
}

static double brightest_of_scene(const struct render_job *job) {
    const struct world *world = job->world;
    double max = sky_brightest(&world->sky), lit = largest(job->ambient);
    for (uint32_t i = 0; i < world->light_count; i++) {
        const struct light *light = &world->lights[i];
        double own = light_brightest(light);
        lit += own;
        if (light->visible && own > max)
            max = own;
    }
    max = fmax(max, lit + world->emission_bound);
    return job->fog ? fmax(max, largest(job->fog->colour)) : max;
}

double cutoff_weight(const struct render_job *job) {
    const struct tone *tone = &job->settings.tone;
    double brightest = brightest_of_scene(job), cutoff = job->settings.cutoff;
    if (cutoff <= 0)
        return 0;
    if (tone->exposure > 0)
        cutoff /= el_exp2(tone->exposure);
    if (tone->srgb)
        cutoff /= 12.92; /* the slope of the transfer function in the dark */
    return brightest > 1 ? cutoff / brightest : cutoff;
}
