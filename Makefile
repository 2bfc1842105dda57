# gray: make [config=release|debug|asan|tsan|fuzz] [CC=gcc|clang]
#   all (default)  ./gray and the link ./rt       test        the tests, at most 8 minutes
#   test-long      the rest, restartable by name   layers      includes against the order of rooms
#   bench          benchmarks                      install     PREFIX, DESTDIR
config ?= release
PREFIX ?= /usr/local
DESTDIR ?=
BUILD ?= build/$(config)
PKG_CONFIG ?= pkg-config

ROOMS = base math expr image accel geom look scene formats world render script app

WARNINGS = -Wall -Wextra -Wpedantic -Wshadow -Wconversion
# The same bits everywhere: no contraction to fused operations, no reordering.
EXACT = -ffp-contract=off -fno-fast-math
CFLAGS.release = -O3 -g -DNDEBUG
CFLAGS.debug = -O0 -g -DGRAY_FAULTS
CFLAGS.asan = -O1 -g -DGRAY_FAULTS -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
CFLAGS.tsan = -O1 -g -DGRAY_FAULTS -fsanitize=thread
CFLAGS.fuzz = -O1 -g -DGRAY_FAULTS -fsanitize=fuzzer-no-link,address,undefined -fno-omit-frame-pointer
ifeq ($(CFLAGS.$(config)),)
$(error config=$(config) is none of release, debug, asan, tsan, fuzz)
endif
ifeq ($(config),fuzz)
CC = clang
endif

LUA_NAME := $(firstword $(foreach name,lua5.4 lua-5.4 lua54,$(shell $(PKG_CONFIG) --exists $(name) 2>/dev/null && echo $(name))))
LUA_CFLAGS := $(if $(LUA_NAME),$(shell $(PKG_CONFIG) --cflags $(LUA_NAME)))
LUA_LIBS := $(if $(LUA_NAME),$(shell $(PKG_CONFIG) --libs $(LUA_NAME)))
PNG_CFLAGS := $(shell $(PKG_CONFIG) --cflags libpng 2>/dev/null)
PNG_LIBS := $(shell $(PKG_CONFIG) --libs libpng 2>/dev/null)

override CFLAGS += -std=gnu11 $(WARNINGS) $(EXACT) $(CFLAGS.$(config)) -pthread
override CPPFLAGS += -Isrc -I. $(LUA_CFLAGS) $(PNG_CFLAGS) -DGRAY_CONFIG='"$(config)"' -DGRAY_PREFIX='"$(PREFIX)"'
override LDLIBS += $(LUA_LIBS) $(PNG_LIBS) -lm
override LDFLAGS += -pthread

SOURCES := $(sort $(foreach room,$(ROOMS),$(wildcard src/$(room)/*.c)))
MAIN := src/app/main.c
OBJECTS := $(patsubst %.c,$(BUILD)/%.o,$(filter-out $(MAIN),$(SOURCES)))
MAIN_OBJECT := $(patsubst %.c,$(BUILD)/%.o,$(MAIN))
TEST_SOURCES := $(sort $(wildcard tests/unit/*.c)) tests/harness.c tests/stage.c
TEST_OBJECTS := $(patsubst %.c,$(BUILD)/%.o,$(TEST_SOURCES))
ALL_OBJECTS := $(OBJECTS) $(MAIN_OBJECT) $(TEST_OBJECTS)

ifeq ($(config),release)
all: check-libraries $(BUILD)/gray
	@ln -sf $(BUILD)/gray gray && ln -sf gray rt
else
all: check-libraries $(BUILD)/gray
endif

check-libraries:
	@test -n "$(LUA_NAME)" || { echo "gray needs Lua 5.4 with headers (Debian: liblua5.4-dev pkg-config); tools/setup.sh installs it" >&2; exit 1; }
	@test -n "$(PNG_LIBS)" || { echo "gray needs libpng with headers (Debian: libpng-dev pkg-config); tools/setup.sh installs it" >&2; exit 1; }

$(BUILD)/gray: $(OBJECTS) $(MAIN_OBJECT)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LDLIBS)

$(BUILD)/tests/run: $(OBJECTS) $(TEST_OBJECTS)
	$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LDLIBS)

# Kernels for one instruction set each live in files of their own; fused operations stay off.
$(BUILD)/src/accel/%_avx2.o: override CFLAGS += -mavx2 -mno-fma
$(BUILD)/src/accel/%_avx512.o: override CFLAGS += -mavx512f -mavx512vl -mavx512dq -mavx512bw -mno-fma
# Its functions are the C library's own names: the compiler must not see calls of itself in them.
$(BUILD)/src/script/libm_override.o: override CFLAGS += -fno-builtin

# A change of compiler or flags rebuilds everything.
FLAGS_STAMP := $(BUILD)/flags
$(BUILD)/%.o: %.c $(FLAGS_STAMP)
	@mkdir -p $(@D)
	$(CC) $(CPPFLAGS) $(CFLAGS) -MMD -MP -c -o $@ $<
$(FLAGS_STAMP): force
	@mkdir -p $(@D)
	@echo '$(CC) $(CPPFLAGS) $(CFLAGS)' | cmp -s - $@ || echo '$(CC) $(CPPFLAGS) $(CFLAGS)' > $@

build-tests: $(BUILD)/gray $(BUILD)/tests/run

test:
	@tools/test.sh
test-long:
	@tools/test.sh --long $(ONLY)
layers:
	@tools/layers.sh
bench: all
	@bench/run.sh
format:
	clang-format -i $(SOURCES) $(wildcard src/*/*.h tests/*.c tests/*.h tests/unit/*.c)

install: all
	install -d $(DESTDIR)$(PREFIX)/bin $(DESTDIR)$(PREFIX)/share/gray/lua $(DESTDIR)$(PREFIX)/share/doc/gray
	install -m 755 $(BUILD)/gray $(DESTDIR)$(PREFIX)/bin/gray
	install -m 644 lua/*.lua $(DESTDIR)$(PREFIX)/share/gray/lua
	install -m 644 README.md LICENSE CHANGELOG.md $(DESTDIR)$(PREFIX)/share/doc/gray

clean:
	rm -rf build gray rt

force:
.PHONY: all check-libraries build-tests test test-long layers bench format install clean force
-include $(ALL_OBJECTS:.o=.d)
