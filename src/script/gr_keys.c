/* gr.keys: values at times, and a function of seconds that interpolates them. Every value is a row of numbers, divided
 * into fields of three kinds: numbers that are mixed linearly, quaternions and directions. The latter two are points of
 * unit spheres, where a great circle replaces the straight line (K. Shoemake, "Animating Rotation with Quaternion
 * Curves", SIGGRAPH 1985). Between two keys every curve is a cubic Bezier curve, evaluated by de Casteljau's scheme
 * with the mix of the field. So a value that does not change keeps its bits. The inner control values of curve =
 * 'catmull' are a third of a step along the tangents of Catmull and Rom, "A Class of Local Interpolating Splines",
 * 1974, for keys at any distances. */
#include "script/gr_keys_internal.h"

#include "base/unreachable.h"
#include "call/display_colour.h"
#include "math/elementary.h"
#include "record/symbol.h"
#include "script/script_internal.h"

#include <lauxlib.h>
#include <math.h>
#include <string.h>

enum { FIELDS_MAX = 32, KEYS_MAX = 1 << 20, WIDTH_MAX = 64 };

enum field_kind { FIELD_NUMBER, FIELD_TUPLE, FIELD_COLOUR, FIELD_TURN, FIELD_DIRECTION };
enum key_curve { CURVE_LINEAR, CURVE_CATMULL, CURVE_BEZIER };

struct key_field {
    enum field_kind kind;
    uint32_t offset, count; /* its numbers in a row */
};

/* The result of one call of gr.keys: a block of Lua memory, which is an upvalue of the function. A row has `width`
 * numbers. */
struct keys {
    struct key_field fields[FIELDS_MAX];
    uint32_t field_count, width, count;
    bool named; /* the value is a table of the fields; otherwise it is the only field */
    enum key_curve curve;
    double numbers[]; /* count times; count values, as many controls before and after them: rows */
};

enum row { ROW_VALUE, ROW_BEFORE, ROW_AFTER };

static double *row_of(struct keys *keys, enum row row, uint32_t key) {
    return keys->numbers + keys->count + ((size_t)row * keys->count + key) * keys->width;
}

/* --- values --- */

static bool is_unit(enum field_kind kind) {
    return kind == FIELD_TURN || kind == FIELD_DIRECTION;
}

static double length_of(const double *v, uint32_t count) {
    double sum = 0;
    for (uint32_t i = 0; i < count; i++)
        sum += v[i] * v[i];
    return sqrt(sum);
}

/* False: it has length 0. */
static bool normalize(double *v, uint32_t count) {
    double length = length_of(v, count);
    if (!(length > 0) || !isfinite(length))
        return false;
    for (uint32_t i = 0; i < count; i++)
        v[i] /= length;
    return true;
}

/* The angle between unit vectors (W. Kahan, "How Futile are Mindless Assessments of Roundoff in Floating-Point
 * Computation?", 2006, section 12). */
static double angle_of(const double *a, const double *b, uint32_t count) {
    double difference[4], sum[4];
    for (uint32_t i = 0; i < count; i++) {
        difference[i] = a[i] - b[i];
        sum[i] = a[i] + b[i];
    }
    return 2 * el_atan2(length_of(difference, count), length_of(sum, count));
}

/* out may be a or b. The result is a for opposite vectors, which have no shortest great circle. */
static void mix_units(const double *a, const double *b, uint32_t count, double share, double *out) {
    double angle = angle_of(a, b, count), sine = el_sin(angle);
    double from = el_sin((1 - share) * angle), to = el_sin(share * angle);
    if (angle == 0 || !(sine > 0x1p-40)) {
        from = sine = 1;
        to = 0;
    }
    for (uint32_t i = 0; i < count; i++)
        out[i] = (from * a[i] + to * b[i]) / sine;
}

static void mix(const struct key_field *field, const double *a, const double *b, double share, double *out) {
    if (is_unit(field->kind)) {
        mix_units(a, b, field->count, share, out);
        return;
    }
    for (uint32_t i = 0; i < field->count; i++)
        out[i] = a[i] + (b[i] - a[i]) * share;
}

/* The difference from a to b. For unit vectors it is the tangent at a whose length is the angle. */
static void difference(const struct key_field *field, const double *a, const double *b, double out[WIDTH_MAX]) {
    for (uint32_t i = 0; i < field->count; i++)
        out[i] = b[i] - a[i];
    if (!is_unit(field->kind))
        return;
    double angle = angle_of(a, b, field->count), along = 0;
    for (uint32_t i = 0; i < field->count; i++)
        along += out[i] * a[i];
    for (uint32_t i = 0; i < field->count; i++)
        out[i] -= along * a[i];
    double scale = normalize(out, field->count) ? angle : 0;
    for (uint32_t i = 0; i < field->count; i++)
        out[i] *= scale;
}

/* The value at `factor` times a difference from a. */
static void move(const struct key_field *field, const double *a, const double *by, double factor, double *out) {
    double scale = factor, keep = 1, length = length_of(by, field->count);
    if (is_unit(field->kind) && length > 0) {
        keep = el_cos(factor * length);
        scale = el_sin(factor * length) / length;
    }
    for (uint32_t i = 0; i < field->count; i++)
        out[i] = keep * a[i] + scale * by[i];
}

/* --- reading --- */

struct reader {
    lua_State *L;
    struct keys *keys;
    int names;      /* stack index: the names of the fields */
    uint32_t key;   /* that is read, from 0 */
    const char *at; /* what is read: "the value" */
};

/* "gr.keys: the value of keys[2]", and of its field `name` if there is one. */
_Noreturn static void refuse(const struct reader *reader, const char *name, const char *why) {
    luaL_error(reader->L, "gr.keys: %s%s%s of keys[%d] %s", name ? name : "", name ? " in " : "", reader->at,
               (int)reader->key + 1, why);
    UNREACHABLE("an error that did not raise");
}

static double number_on_top(const struct reader *reader, const char *name) {
    double x = lua_tonumber(reader->L, -1);
    if (lua_type(reader->L, -1) != LUA_TNUMBER || !isfinite(x))
        refuse(reader, name, "must be of finite numbers");
    lua_pop(reader->L, 1);
    return x;
}

static bool is_colour(lua_State *L, int index, struct vec3 *colour) {
    int type = lua_type(L, index);
    return (type == LUA_TSTRING || (type == LUA_TTABLE && !is_vector(L, index))) && display_colour_at(L, index, colour);
}

static const char *const direction_names[] = {"view", "up", "view_to", "up_to"};

static enum field_kind kind_of(const struct reader *reader, const char *name, int index) {
    struct vec3 colour;
    int type = lua_type(reader->L, index);
    if (type == LUA_TNUMBER)
        return FIELD_NUMBER;
    if (is_colour(reader->L, index, &colour))
        return FIELD_COLOUR;
    if (type != LUA_TTABLE)
        refuse(reader, name, "must be a number, a colour or a table of numbers");
    if (name && strcmp(name, "rotate") == 0)
        return FIELD_TURN;
    for (size_t i = 0; name && i < sizeof direction_names / sizeof *direction_names; i++) {
        if (strcmp(name, direction_names[i]) == 0)
            return FIELD_DIRECTION;
    }
    return FIELD_TUPLE;
}

static uint32_t count_of(const struct reader *reader, enum field_kind kind, const char *name, int index) {
    if (kind == FIELD_NUMBER)
        return 1;
    lua_Unsigned count = kind == FIELD_COLOUR ? 3 : lua_rawlen(reader->L, index);
    if (kind == FIELD_TURN && count != 4)
        refuse(reader, name, "must be a quaternion {w, x, y, z}");
    if (kind == FIELD_DIRECTION && count != 3)
        refuse(reader, name, "must be a direction {x, y, z}");
    if (count == 0 || count > WIDTH_MAX)
        refuse(reader, name, "must be a table of 1 to 64 numbers");
    return (uint32_t)count;
}

/* A field of the first key determines the form of the others. */
static void describe_field(const struct reader *reader, const char *name, int index) {
    struct keys *keys = reader->keys;
    struct key_field *field = &keys->fields[keys->field_count];
    field->kind = kind_of(reader, name, index);
    field->count = count_of(reader, field->kind, name, index);
    field->offset = keys->width;
    keys->width += field->count;
    keys->field_count++;
    if (keys->width > WIDTH_MAX)
        refuse(reader, NULL, "has more than 64 numbers");
}

/* A table without entry 1 and without the mark of a colour has named fields. */
static bool has_names(lua_State *L, int index) {
    struct vec3 colour;
    if (lua_type(L, index) != LUA_TTABLE || is_colour(L, index, &colour))
        return false;
    bool named = lua_rawgeti(L, index, 1) == LUA_TNIL;
    lua_pop(L, 1);
    return named;
}

/* Collects the names of the table at an index, in byte order, in the table at reader->names. */
static void list_names(const struct reader *reader, int index) {
    lua_State *L = reader->L;
    const char *names[FIELDS_MAX];
    uint32_t count = 0;
    for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1)) {
        if (lua_type(L, -2) != LUA_TSTRING)
            refuse(reader, NULL, "must be a number, a table of numbers, or a table with names");
        if (count == FIELDS_MAX)
            refuse(reader, NULL, "has more than 32 fields");
        uint32_t i = count++;
        const char *name = lua_tostring(L, -2);
        for (; i > 0 && strcmp(names[i - 1], name) > 0; i--)
            names[i] = names[i - 1];
        names[i] = name;
    }
    if (count == 0)
        refuse(reader, NULL, "is an empty table");
    for (uint32_t i = 0; i < count; i++) {
        lua_pushstring(L, names[i]);
        lua_rawseti(L, reader->names, (lua_Integer)i + 1);
    }
}

/* Pushes the name of a field, and returns it. For a value without names it pushes nothing and returns NULL. */
static const char *push_name(lua_State *L, const struct keys *keys, int names, uint32_t field) {
    if (!keys->named)
        return NULL;
    (void)lua_rawgeti(L, names, (lua_Integer)field + 1);
    return lua_tostring(L, -1);
}

static void describe_value(const struct reader *reader, int index) {
    struct keys *keys = reader->keys;
    lua_State *L = reader->L;
    keys->named = has_names(L, index);
    if (!keys->named) {
        describe_field(reader, NULL, index);
        return;
    }
    list_names(reader, index);
    for (lua_Unsigned i = 0, count = lua_rawlen(L, reader->names); i < count; i++) {
        const char *name = push_name(L, keys, reader->names, (uint32_t)i);
        lua_pushvalue(L, -1);
        (void)lua_rawget(L, index);
        describe_field(reader, name, lua_gettop(L));
        lua_pop(L, 2);
    }
}

static void read_field(const struct reader *reader, const struct key_field *field, const char *name, int index,
                       double *out) {
    lua_State *L = reader->L;
    struct vec3 colour;
    if (lua_isnil(L, index))
        refuse(reader, name, "is missing");
    if (kind_of(reader, name, index) != field->kind || count_of(reader, field->kind, name, index) != field->count)
        refuse(reader, name, "is of another kind than the value of keys[1]");
    if (field->kind == FIELD_COLOUR && is_colour(L, index, &colour)) {
        out[0] = colour.x, out[1] = colour.y, out[2] = colour.z;
        return;
    }
    for (uint32_t i = 0; i < field->count; i++) {
        if (field->kind == FIELD_NUMBER)
            lua_pushvalue(L, index);
        else
            (void)lua_rawgeti(L, index, (lua_Integer)i + 1);
        out[i] = number_on_top(reader, name);
    }
    if (is_unit(field->kind) && !normalize(out, field->count))
        refuse(reader, name, "must not be 0");
}

static void read_value(const struct reader *reader, int index, double *row) {
    const struct keys *keys = reader->keys;
    lua_State *L = reader->L;
    if (keys->named != has_names(L, index))
        refuse(reader, NULL, "is of another kind than the value of keys[1]");
    for (uint32_t i = 0; i < keys->field_count; i++) {
        const struct key_field *field = &keys->fields[i];
        const char *name = push_name(L, keys, reader->names, i);
        if (name) {
            lua_pushvalue(L, -1);
            (void)lua_rawget(L, index);
        } else {
            lua_pushvalue(L, index);
        }
        read_field(reader, field, name, lua_gettop(L), row + field->offset);
        lua_pop(L, name ? 2 : 1);
    }
    if (!keys->named)
        return;
    lua_Unsigned given = 0;
    for (lua_pushnil(L); lua_next(L, index); lua_pop(L, 1))
        given++;
    if (given != keys->field_count)
        refuse(reader, NULL, "has other fields than the value of keys[1]");
}

/* Pushes entry or field `name` of the key at an index. */
static bool push_part(lua_State *L, int key, const char *name) {
    lua_pushstring(L, name);
    return lua_rawget(L, key) != LUA_TNIL;
}

static void read_time(const struct reader *reader, int key) {
    struct keys *keys = reader->keys;
    lua_State *L = reader->L;
    bool is_number = lua_rawgeti(L, key, 1) == LUA_TNUMBER;
    double time = is_number ? lua_tonumber(L, -1) : NAN;
    lua_pop(L, 1);
    if (!isfinite(time))
        luaL_error(L, "gr.keys: keys[%d] must be {seconds, value}%s", (int)reader->key + 1,
                   is_number ? ", with a finite number of seconds" : "");
    keys->numbers[reader->key] = time;
    if (reader->key > 0 && !(time > keys->numbers[reader->key - 1]))
        luaL_error(L, "gr.keys: the time of keys[%d] is %f, not later than that of keys[%d], %f", (int)reader->key + 1,
                   time, (int)reader->key, keys->numbers[reader->key - 1]);
}

/* Reads the key at an absolute index, with its controls. */
static void read_key(struct reader *reader, int key) {
    static const char *const controls[] = {[ROW_BEFORE] = "before", [ROW_AFTER] = "after"};
    struct keys *keys = reader->keys;
    lua_State *L = reader->L;
    read_time(reader, key);
    (void)lua_rawgeti(L, key, 2);
    reader->at = "the value";
    read_value(reader, lua_gettop(L), row_of(keys, ROW_VALUE, reader->key));
    lua_pop(L, 1);
    for (enum row row = ROW_BEFORE; row <= ROW_AFTER; row++) {
        double *out = row_of(keys, row, reader->key);
        memcpy(out, row_of(keys, ROW_VALUE, reader->key), keys->width * sizeof *out);
        if (push_part(L, key, controls[row])) {
            reader->at = controls[row];
            if (keys->curve != CURVE_BEZIER)
                refuse(reader, NULL, "needs curve = 'bezier'");
            read_value(reader, lua_gettop(L), out);
        }
        lua_pop(L, 1);
    }
    for (lua_pushnil(L); lua_next(L, key); lua_pop(L, 1)) {
        bool known = lua_isinteger(L, -2)
                         ? lua_tointeger(L, -2) <= 2
                         : lua_type(L, -2) == LUA_TSTRING && (strcmp(lua_tostring(L, -2), "before") == 0 ||
                                                              strcmp(lua_tostring(L, -2), "after") == 0);
        if (!known)
            luaL_error(L, "gr.keys: keys[%d] must be {seconds, value}, for 'bezier' with before and after",
                       (int)reader->key + 1);
    }
}

/* --- controls --- */

/* A quaternion and its negative are the same rotation. Of the two, the one closer to its neighbour is chosen, for the
 * shorter rotation. */
static void choose_side(const struct key_field *field, const double *neighbour, double *value) {
    double dot = 0;
    if (field->kind != FIELD_TURN)
        return;
    for (uint32_t i = 0; i < field->count; i++)
        dot += neighbour[i] * value[i];
    for (uint32_t i = 0; dot < 0 && i < field->count; i++)
        value[i] = -value[i];
}

/* The derivative at a key, times a third of the steps on both sides. */
static void set_tangent(struct keys *keys, const struct key_field *field, uint32_t key) {
    const double *times = keys->numbers;
    uint32_t first = key > 0 ? key - 1 : key, last = key + 1 < keys->count ? key + 1 : key;
    const double *value = row_of(keys, ROW_VALUE, key) + field->offset;
    double forward[WIDTH_MAX], backward[WIDTH_MAX], span = times[last] - times[first];
    if (first == last)
        return;
    difference(field, value, row_of(keys, ROW_VALUE, last) + field->offset, forward);
    difference(field, value, row_of(keys, ROW_VALUE, first) + field->offset, backward);
    for (uint32_t i = 0; i < field->count; i++)
        forward[i] = (forward[i] - backward[i]) / span;
    move(field, value, forward, (times[first] - times[key]) / 3, row_of(keys, ROW_BEFORE, key) + field->offset);
    move(field, value, forward, (times[last] - times[key]) / 3, row_of(keys, ROW_AFTER, key) + field->offset);
}

static void make_controls(struct reader *reader) {
    struct keys *keys = reader->keys;
    lua_State *L = reader->L;
    for (uint32_t f = 0; f < keys->field_count; f++) {
        const struct key_field *field = &keys->fields[f];
        for (reader->key = 0; reader->key < keys->count; reader->key++) {
            double *value = row_of(keys, ROW_VALUE, reader->key) + field->offset;
            const double *last = reader->key > 0 ? row_of(keys, ROW_VALUE, reader->key - 1) + field->offset : value;
            choose_side(field, last, value);
            choose_side(field, value, row_of(keys, ROW_BEFORE, reader->key) + field->offset);
            choose_side(field, value, row_of(keys, ROW_AFTER, reader->key) + field->offset);
            reader->at = "the value";
            if (field->kind == FIELD_DIRECTION && angle_of(last, value, 3) > PI - 1e-6)
                refuse(reader, push_name(L, keys, reader->names, f),
                       "is opposite to that of the previous key: there is no shortest rotation between them");
        }
        for (uint32_t key = 0; keys->curve == CURVE_CATMULL && key < keys->count; key++)
            set_tangent(keys, field, key);
    }
}

/* --- the function --- */

/* The value of a field in the interval from `key` on. */
static void interpolate(struct keys *keys, const struct key_field *field, uint32_t key, double share, double *out) {
    double c[4][WIDTH_MAX];
    const double *rows[4] = {row_of(keys, ROW_VALUE, key), row_of(keys, ROW_AFTER, key),
                             row_of(keys, ROW_BEFORE, key + 1), row_of(keys, ROW_VALUE, key + 1)};
    if (keys->curve == CURVE_LINEAR) {
        mix(field, rows[0] + field->offset, rows[3] + field->offset, share, out);
        return;
    }
    for (int i = 0; i < 4; i++)
        memcpy(c[i], rows[i] + field->offset, field->count * sizeof **c);
    for (int left = 3; left > 0; left--)
        for (int i = 0; i < left; i++)
            mix(field, c[i], c[i + 1], share, c[i]);
    memcpy(out, c[0], field->count * sizeof *out);
}

static void push_field(lua_State *L, const struct key_field *field, const double *numbers) {
    if (field->kind == FIELD_NUMBER) {
        lua_pushnumber(L, numbers[0]);
        return;
    }
    if (field->kind != FIELD_COLOUR && field->count == 3) {
        for (int i = 0; i < 3; i++)
            lua_pushnumber(L, numbers[i]);
        push_vector(L);
        return;
    }
    lua_createtable(L, (int)field->count, 1);
    for (uint32_t i = 0; i < field->count; i++) {
        lua_pushnumber(L, numbers[i]);
        lua_rawseti(L, -2, (lua_Integer)i + 1);
    }
    if (field->kind == FIELD_COLOUR) {
        lua_pushliteral(L, "srgb");
        lua_setfield(L, -2, "encoding");
    }
}

/* The fraction of the interval, mapped by the function `ease` of the call, upvalue 3. */
static double eased(lua_State *L, double share) {
    if (lua_isnil(L, lua_upvalueindex(3)))
        return share;
    lua_pushvalue(L, lua_upvalueindex(3));
    lua_pushnumber(L, share);
    lua_call(L, 1, 1);
    double out = lua_type(L, -1) == LUA_TNUMBER ? lua_tonumber(L, -1) : NAN;
    if (!isfinite(out))
        luaL_error(L, "gr.keys: ease(%f) must be a finite number", share);
    lua_pop(L, 1);
    return out;
}

/* Upvalues: the keys, the names of their fields, ease. */
static int value_at(lua_State *L) {
    struct keys *keys = lua_touserdata(L, lua_upvalueindex(1));
    double row[WIDTH_MAX];
    bool given = !lua_isnoneornil(L, 1);
    if (given && !lua_isnumber(L, 1))
        luaL_error(L, "gr.keys: the time must be a number of seconds, not %s",
                   is_symbol(L, 1) ? "a number of a recorded function" : value_words(L, 1));
    double time = given ? lua_tonumber(L, 1) : frame_time(&script_of(context_of(L))->animation.frame);
    if (isnan(time))
        luaL_error(L, "gr.keys: the time is not a number (nan)");
    /* low: the last key that is not later; high: the first key that is later. */
    uint32_t low = 0, high = keys->count;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if (keys->numbers[middle] <= time)
            low = middle;
        else
            high = middle;
    }
    bool inside = high < keys->count && time > keys->numbers[low];
    double share = 0;
    if (inside)
        share = eased(L, (time - keys->numbers[low]) / (keys->numbers[high] - keys->numbers[low]));
    if (keys->named)
        lua_createtable(L, 0, (int)keys->field_count);
    for (uint32_t i = 0; i < keys->field_count; i++) {
        const struct key_field *field = &keys->fields[i];
        if (inside)
            interpolate(keys, field, low, share, row);
        else
            memcpy(row, row_of(keys, ROW_VALUE, low) + field->offset, field->count * sizeof *row);
        (void)push_name(L, keys, lua_upvalueindex(2), i);
        push_field(L, field, row);
        if (keys->named)
            lua_rawset(L, -3);
    }
    return 1;
}

/* --- the call --- */

static enum key_curve read_curve(lua_State *L) {
    static const char *const words[] = {
        [CURVE_LINEAR] = "linear", [CURVE_CATMULL] = "catmull", [CURVE_BEZIER] = "bezier"};
    enum key_curve curve = CURVE_LINEAR;
    if (push_part(L, 1, "curve")) {
        const char *word = lua_type(L, -1) == LUA_TSTRING ? lua_tostring(L, -1) : "";
        while (curve <= CURVE_BEZIER && strcmp(words[curve], word) != 0)
            curve++;
        if (curve > CURVE_BEZIER)
            luaL_error(L, "gr.keys: curve must be 'linear', 'catmull' or 'bezier'");
    }
    lua_pop(L, 1);
    return curve;
}

static void check_fields(lua_State *L, lua_Unsigned count) {
    for (lua_pushnil(L); lua_next(L, 1); lua_pop(L, 1)) {
        if (lua_isinteger(L, -2) && lua_tointeger(L, -2) > (lua_Integer)count)
            luaL_error(L, "gr.keys: keys[%d] is missing", (int)count + 1);
        if (lua_isinteger(L, -2) && lua_tointeger(L, -2) > 0)
            continue;
        const char *name = lua_type(L, -2) == LUA_TSTRING ? lua_tostring(L, -2) : "";
        if (strcmp(name, "curve") != 0 && strcmp(name, "ease") != 0)
            luaL_error(L, "gr.keys: unknown field '%s'; the fields are curve, ease", luaL_tolstring(L, -2, NULL));
    }
}

static int make_keys(lua_State *L) {
    sandbox_of(L)->running.name = NULL; /* for messages about colours */
    if (lua_gettop(L) != 1 || lua_type(L, 1) != LUA_TTABLE)
        return luaL_error(L, "gr.keys: one table of keys {seconds, value} is needed");
    lua_Unsigned count = lua_rawlen(L, 1);
    if (count == 0 || count > KEYS_MAX)
        return luaL_error(L, "gr.keys: 1 to %d keys {seconds, value} are needed", KEYS_MAX);
    check_fields(L, count);
    struct keys described = {.count = (uint32_t)count, .curve = read_curve(L)};
    lua_newtable(L);
    struct reader reader = {.L = L, .keys = &described, .names = lua_gettop(L), .at = "the value"};
    for (lua_Unsigned i = 1; i <= count; i++) {
        if (lua_rawgeti(L, 1, (lua_Integer)i) != LUA_TTABLE)
            return luaL_error(L, "gr.keys: keys[%d] must be {seconds, value}", (int)i);
        lua_pop(L, 1);
    }
    (void)lua_rawgeti(L, 1, 1);
    (void)lua_rawgeti(L, -1, 2);
    describe_value(&reader, lua_gettop(L));
    lua_settop(L, reader.names);
    size_t numbers = (size_t)count * (1 + 3 * (size_t)described.width);
    struct keys *keys = lua_newuserdatauv(L, sizeof *keys + numbers * sizeof *keys->numbers, 0);
    *keys = described;
    reader.keys = keys;
    for (reader.key = 0; reader.key < keys->count; reader.key++) {
        (void)lua_rawgeti(L, 1, (lua_Integer)reader.key + 1);
        read_key(&reader, lua_gettop(L));
        lua_pop(L, 1);
    }
    make_controls(&reader);
    lua_pushvalue(L, reader.names);
    if (push_part(L, 1, "ease") && lua_type(L, -1) != LUA_TFUNCTION)
        return luaL_error(L, "gr.keys: ease must be a function, as those of the library easing");
    lua_pushcclosure(L, value_at, 3);
    return 1;
}

static const struct value_function functions[] = {
    {"keys", "keys",
     "A function of seconds (gr.time) that interpolates keys {seconds, value}; fields: curve = 'linear', 'catmull' or "
     "'bezier', and ease.",
     "fun(seconds?: number): any", make_keys},
};
const struct value_functions key_functions = {functions, sizeof functions / sizeof functions[0]};
