#include "script/gr_bevel_internal.h"

#include "math/portable.h"

bool bevel_prism(struct script_context *context, const struct prism_input *input, const struct script_value *edge,
                 const struct script_value *chamfer, struct shape *shape, struct error *error) {
    if (!chamfer->boolean) {
        shape->kind = SHAPE_BEVELLED;
        shape->bevelled = bevelled_prism(&context->scene.arena, &context->sandbox.call, input, edge->number, error);
        return shape->bevelled != NULL;
    }
    struct chamfered_prism faces;
    if (!chamfered_prism(&context->sandbox.call, input, edge->number, &faces, error))
        return false;
    const struct mesh_input mesh = {.name = "prism",
                                    .vertex_count = faces.vertex_count,
                                    .face_count = faces.face_count,
                                    .vertices = (const double(*)[3])faces.vertices,
                                    .face_start = faces.face_start,
                                    .vertex_index = faces.vertex_index};
    shape->kind = SHAPE_MESH;
    shape->mesh = assets_mesh(context->scene.assets, &mesh, error);
    return shape->mesh != NULL;
}

static bool is_narrow(double edge, double limit, const char *what, struct error *error) {
    return edge < limit || error_set(error, ERROR_SCENE, "edge (%g) must be less than %s (%g)", edge, what, limit);
}

bool bevel_box(struct script_context *context, const struct box *box, const struct script_value *edge,
               const struct script_value *chamfer, struct shape *shape, struct error *error) {
    const double points[4][2] = {
        {box->min.x, box->min.z}, {box->min.x, box->max.z}, {box->max.x, box->max.z}, {box->max.x, box->min.z}};
    const uint32_t starts[2] = {0, 4};
    const struct prism_input prism = {SPLINE_LINEAR, points, starts, 1, box->min.y, box->max.y};
    const struct vec3 size = vec3_sub(box->max, box->min);
    return is_narrow(edge->number, math_min(math_min(size.x, size.y), size.z) / 2, "half of the shortest side",
                     error) &&
           bevel_prism(context, &prism, edge, chamfer, shape, error);
}

bool bevel_cylinder(struct script_context *context, struct bevelled_cylinder *input, const struct script_value *edge,
                    const struct script_value *chamfer, struct shape *shape, struct error *error) {
    input->edge = edge->number;
    input->chamfer = chamfer->boolean;
    if (!is_narrow(input->edge, input->radius, "the radius", error) ||
        !is_narrow(input->edge, vec3_length(vec3_sub(input->to, input->from)) / 2, "half of the length", error))
        return false;
    shape->kind = SHAPE_BEVELLED;
    shape->bevelled = bevelled_cylinder(&context->scene.arena, input, error);
    return shape->bevelled != NULL;
}
