# gray: make [TARGET] [config=release|debug|asan|tsan|fuzz|afl|coverage] [CC=gcc|clang] [WERROR=1] [V=1]
#   all (default)  ./gray and the link ./rt        help        this list
#   test, check    the tests, at most 8 minutes    test-long   the rest, restartable by name (ONLY="name ...")
#   test-fast      the tests that start no program, below a minute
#   check-clang    clang reads all sources; its warnings are errors
#   layers         includes against the order of modules; names (tools/names.list); sizes of files, parameters
#   format         clang-format over all sources
#   coverage       lines and branches that the tests reach, in build/coverage (clang; COVERAGE="word ..." for some tests)
#   fuzz           every tests/fuzz/fuzz_*.c for FUZZ_SECONDS each (clang's libFuzzer; FUZZ="name ..." for some)
#   fuzz-afl       the same with AFL++
#   arm, test-arm  build/arm/gray for 64-bit ARM, from another machine; its pictures under qemu against the recorded ones
#   musl, test-musl  build/musl/gray with the C library musl, linked statically; its pictures
#   gpu            the kernels for graphics cards (clang, LLVM 14 or newer), beside the program
#   test-gpu       pictures by a graphics card against those of the processor
#   scan-device    compiles what a ray touches for graphics cards, without one, and checks its operations
#   bench          the benchmarks                  install     into PREFIX, below DESTDIR
#   clean          removes all that make has built  uninstall   removes what install has written there
# Objects and programs lie in build/CONFIG. With BUILD=FOLDER they lie in FOLDER, and make writes nothing elsewhere.
# The build prints one line for each file; V=1 prints the commands.
config ?= release
PREFIX ?= /usr/local
DESTDIR ?=
# Whether the caller names the folder, and the folder of another configuration beside it.
BUILD_GIVEN := $(if $(filter undefined,$(origin BUILD)),,yes)
beside = $(if $(BUILD_GIVEN),$(BUILD),build)/$(1)
BUILD ?= build/$(config)
ifeq ($(abspath $(BUILD)),$(CURDIR))
$(error BUILD is the folder of the sources)
endif
comma := ,
# A recipe that begins with $(call say,WORD,NAME) prints one line, and its command with V=1 only; make -s prints nothing.
V ?=
Q = $(if $(V),,@)
SILENT := $(findstring s,$(firstword -$(MAKEFLAGS)))
say = $(if $(V)$(SILENT),,@printf '  %-6s %s\n' '$(1)' '$(2)')

MODULES = base math image settings film denoise expr accel geometry mesh shape csg material light scene formats world export photon radiosity render device sandbox record call compat script session inspect output preview window viewer host

# -Wswitch-enum: a switch over a closed set names every member, also where it has a default.
WARNINGS = -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wswitch-enum -Wcast-qual $(CLANG_WARNINGS)
# clang warns of each loop that it leaves scalar where the text asks for vectors.
CLANG_WARNINGS = $(if $(findstring clang,$(CC)),-Wno-pass-failed)
# The same bits everywhere: no contraction to fused operations, no reordering.
# Nothing asks for errno of arithmetic; without it sqrt needs no call.
EXACT = -ffp-contract=off -fno-fast-math -fno-math-errno
CFLAGS.release = -O3 -g -DNDEBUG
CFLAGS.debug = -O0 -g -DGRAY_FAULTS
CFLAGS.asan = -Og -g1 -DGRAY_FAULTS -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all -fno-omit-frame-pointer
CFLAGS.tsan = -O1 -g1 -DGRAY_FAULTS -fsanitize=thread
CFLAGS.fuzz = -O1 -g -DGRAY_FAULTS -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
CFLAGS.afl = -O1 -g -DGRAY_FAULTS -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
# Counters live in a file that every process of the tests maps before anything else (%c), so that nothing that ends a
# process loses them, and nothing needs to be written by a confined one; atomic, so that none is lost to a race.
COUNTERS = -fprofile-instr-generate=$(abspath $(BUILD))/raw/%m%c.profraw -fcoverage-mapping -fprofile-update=atomic \
    -mllvm -runtime-counter-relocation -Wno-unused-command-line-argument
CFLAGS.coverage = -O1 -g -DGRAY_FAULTS $(COUNTERS)
CFLAGS.clang = -DGRAY_FAULTS -fsyntax-only
ifeq ($(CFLAGS.$(config)),)
$(error config=$(config) is none of release, debug, asan, tsan, fuzz, afl, coverage, clang)
endif
ifneq ($(filter $(config),fuzz coverage clang),)
CC = clang
endif
ifeq ($(config),afl)
CC = afl-clang-fast
endif
# The machine that is compiled for. Libraries of another one than this lie in Debian's folders.
MACHINE := $(firstword $(subst -, ,$(shell $(CC) -dumpmachine)))
PKG_CONFIG ?= $(if $(filter $(MACHINE),$(shell uname -m)),,env PKG_CONFIG_LIBDIR=/usr/lib/$(MACHINE)-linux-gnu/pkgconfig:/usr/share/pkgconfig )pkg-config
# Jobs of a make that is started here, unless the caller gave a number.
JOBS = $(if $(findstring -j,$(MAKEFLAGS)),,-j$(shell nproc 2>/dev/null || echo 2))

LUA_NAME := $(firstword $(foreach name,lua5.4 lua-5.4 lua54,$(shell $(PKG_CONFIG) --exists $(name) 2>/dev/null && echo $(name))) $(shell $(PKG_CONFIG) --exists 'lua >= 5.4' 'lua < 5.5' 2>/dev/null && echo lua))
LUA_CFLAGS := $(if $(LUA_NAME),$(shell $(PKG_CONFIG) --cflags $(LUA_NAME)))
LUA_LIBS := $(if $(LUA_NAME),$(shell $(PKG_CONFIG) --libs $(LUA_NAME)))
PNG_CFLAGS := $(shell $(PKG_CONFIG) --cflags libpng 2>/dev/null)
PNG_LIBS := $(shell $(PKG_CONFIG) --libs libpng zlib 2>/dev/null)
# Optional: without them gray is whole, but reads no JPEG (libjpeg), no glTF (jansson), no fonts (FreeType) and no EXR
# (OpenEXR, of which only the C library is used), and reads and writes no WebP (libwebp).
JPEG_LIBS := $(shell $(PKG_CONFIG) --libs libjpeg 2>/dev/null)
JANSSON_LIBS := $(shell $(PKG_CONFIG) --libs jansson 2>/dev/null)
EXR_LIBS := $(filter -lOpenEXRCore% -L%,$(shell $(PKG_CONFIG) --libs OpenEXR 2>/dev/null))
WEBP_LIBS := $(shell $(PKG_CONFIG) --libs libwebpmux libwebpdemux libwebp 2>/dev/null)
WEBP_CFLAGS := $(if $(PLAIN),,$(if $(WEBP_LIBS),-DHAVE_WEBP $(shell $(PKG_CONFIG) --cflags libwebpmux libwebpdemux libwebp)))
MPI_NAME := $(firstword $(foreach name,ompi-c mpich,$(shell $(PKG_CONFIG) --exists $(name) 2>/dev/null && echo $(name))))
MPI_CFLAGS := $(if $(MPI_NAME),$(patsubst -I%,-isystem %,$(shell $(PKG_CONFIG) --cflags $(MPI_NAME))))
MPI_LIBS := $(if $(MPI_NAME),$(shell $(PKG_CONFIG) --libs $(MPI_NAME)))
FREETYPE_LIBS := $(shell $(PKG_CONFIG) --libs freetype2 2>/dev/null)
GTK_CFLAGS := $(patsubst -I%,-isystem %,$(shell $(PKG_CONFIG) --cflags gtk4 2>/dev/null))
GTK_LIBS := $(shell $(PKG_CONFIG) --libs gtk4 2>/dev/null)
OPTIONAL_CFLAGS := $(if $(JPEG_LIBS),-DHAVE_JPEG $(shell $(PKG_CONFIG) --cflags libjpeg)) \
    $(if $(JANSSON_LIBS),-DHAVE_JANSSON $(shell $(PKG_CONFIG) --cflags jansson)) \
    $(if $(FREETYPE_LIBS),-DHAVE_FREETYPE $(shell $(PKG_CONFIG) --cflags freetype2)) \
    $(if $(GTK_LIBS),-DHAVE_GTK) $(if $(MPI_LIBS),-DHAVE_MPI) \
    $(if $(EXR_LIBS),-DHAVE_EXR $(patsubst -I%,-isystem %,$(filter -I%,$(shell $(PKG_CONFIG) --cflags OpenEXR))))

# PLAIN=1: as if no optional library were there.
ifneq ($(PLAIN),)
override OPTIONAL_CFLAGS :=
endif

override CFLAGS += -std=gnu11 $(WARNINGS) $(EXACT) $(CFLAGS.$(config)) -pthread
override CPPFLAGS += -Isrc -I. $(LUA_CFLAGS) $(PNG_CFLAGS) $(OPTIONAL_CFLAGS) -DGRAY_CONFIG='"$(config)"'
override LDLIBS += $(LUA_LIBS) $(PNG_LIBS) $(JPEG_LIBS) $(JANSSON_LIBS) $(FREETYPE_LIBS) $(EXR_LIBS) $(WEBP_LIBS) -lm
override LDFLAGS += -pthread

# Kernels for AVX are kernels of x86-64.
SOURCES := $(filter-out $(if $(filter x86_64,$(MACHINE)),,%_avx2.c %_avx512.c),$(sort $(foreach module,$(MODULES),$(wildcard src/$(module)/*.c))))
# Files with a main function; those of gray-gui and gray-mpi replace the one of program.c.
MAIN := src/host/program.c
MPI_MAIN := src/host/main_mpi.c
GUI_SOURCES := src/host/main_gui.c $(wildcard src/window/gtk_*.c)
# Lua and tables in src, which become constants of the program: their lines.
EMBEDDED := $(sort $(wildcard src/*/*.lua src/*/*.txt))
EMBEDDED_OBJECTS := $(EMBEDDED:%=$(BUILD)/%.o)
OBJECTS := $(patsubst %.c,$(BUILD)/%.o,$(filter-out $(MAIN) $(MPI_MAIN) $(GUI_SOURCES),$(SOURCES))) $(EMBEDDED_OBJECTS)
MAIN_OBJECT := $(patsubst %.c,$(BUILD)/%.o,$(MAIN))
GUI_OBJECTS := $(if $(GTK_LIBS),$(patsubst %.c,$(BUILD)/%.o,$(GUI_SOURCES)))
MPI_OBJECT := $(if $(MPI_LIBS),$(patsubst %.c,$(BUILD)/%.o,$(MPI_MAIN)))
TEST_SOURCES := $(sort $(wildcard tests/unit/*.c tests/unit/*/*.c)) tests/harness.c tests/stage.c tests/attack.c tests/attack_files.c
TEST_OBJECTS := $(patsubst %.c,$(BUILD)/%.o,$(TEST_SOURCES))
# What fuzzers feed; the tests feed it what was found before, under a name for each target.
FUZZ_SOURCES := $(sort $(wildcard tests/fuzz/fuzz_*.c))
FUZZ_OBJECTS := $(patsubst %.c,$(BUILD)/%.o,$(FUZZ_SOURCES))
FUZZ_HELP := $(patsubst %.c,$(BUILD)/%.o,$(filter-out $(FUZZ_SOURCES),$(wildcard tests/fuzz/*.c)))
ifeq ($(filter $(config),fuzz afl),)
$(FUZZ_OBJECTS): override CPPFLAGS += -DLLVMFuzzerTestOneInput=$(notdir $*)_input
TEST_OBJECTS += $(FUZZ_OBJECTS) $(FUZZ_HELP)
endif
ALL_OBJECTS := $(FUZZ_OBJECTS) $(FUZZ_HELP) $(OBJECTS) $(MAIN_OBJECT) $(MPI_OBJECT) $(GUI_OBJECTS) $(TEST_OBJECTS)

ifeq ($(config),release)
all: check-libraries $(BUILD)/gray $(if $(MPI_LIBS),$(BUILD)/gray-mpi) $(if $(GTK_LIBS),$(BUILD)/gray-gui)
ifndef BUILD_GIVEN
	@ln -sf $(BUILD)/gray gray && ln -sf gray rt
endif
else
all: check-libraries $(BUILD)/gray $(if $(GTK_LIBS),$(BUILD)/gray-gui)
ifeq ($(config),coverage)
all: $(if $(MPI_LIBS),$(BUILD)/gray-mpi)
endif
endif

check-libraries:
	@test -n "$(LUA_NAME)" || { echo "gray needs Lua 5.4 with headers (Debian: liblua5.4-dev pkg-config); tools/setup.sh installs it" >&2; exit 1; }
	@test -n "$(PNG_LIBS)" || { echo "gray needs libpng with headers (Debian: libpng-dev pkg-config); tools/setup.sh installs it" >&2; exit 1; }

# A program finds its Lua library beside it where the source tree is not above it.
$(BUILD)/gray: $(OBJECTS) $(MAIN_OBJECT)
	$(call say,LINK,$@)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LDLIBS)$(if $(BUILD_GIVEN), && ln -sfn $(CURDIR)/lua $(BUILD)/lua)

# The program for many machines, where there is MPI: one of its own, so that the other does not load the library.
$(BUILD)/gray-mpi: $(OBJECTS) $(MAIN_OBJECT) $(MPI_OBJECT)
	$(call say,LINK,$@)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LDLIBS) $(MPI_LIBS)
$(BUILD)/gray-gui: $(OBJECTS) $(MAIN_OBJECT) $(GUI_OBJECTS)
	$(call say,LINK,$@)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LDLIBS) $(GTK_LIBS)
$(GUI_OBJECTS): override CPPFLAGS += $(GTK_CFLAGS)
$(BUILD)/$(MPI_MAIN:.c=.o): override CPPFLAGS += $(MPI_CFLAGS)

# A program that was copied to another place finds its Lua library here.
$(MAIN_OBJECT): private override CPPFLAGS += -DGRAY_SOURCES='"$(CURDIR)"'

# It takes only the kernels of these sources.
$(BUILD)/src/device/kernels_file.o: private override CPPFLAGS += -DGRAY_KERNELS_DIGEST='"$(shell tools/device_scan.sh digest)"'
$(BUILD)/src/device/kernels_file.o: $(wildcard src/*/*.[ch] src/device/sources.list tools/device_scan.sh)

$(BUILD)/src/image/webp_read.o $(BUILD)/src/image/webp_write.o $(BUILD)/tests/unit/image/test_animation.o $(BUILD)/tests/unit/image/test_bitmaps.o: override CPPFLAGS += $(WEBP_CFLAGS)
# The harness knows when a test starts a program.
$(BUILD)/tests/run: override LDFLAGS += $(patsubst %,-Wl$(comma)--wrap=%,system execv execl posix_spawnp)
$(BUILD)/tests/run: $(OBJECTS) $(TEST_OBJECTS)
	$(call say,LINK,$@)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LDLIBS)

# Benchmarks that are programs of their own.
$(BUILD)/bench/formats $(BUILD)/bench/shapes $(BUILD)/bench/area_lights $(BUILD)/bench/expr $(BUILD)/bench/moving: $(BUILD)/bench/%: $(BUILD)/bench/%.o $(OBJECTS)
	$(call say,LINK,$@)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LDLIBS)

# Kernels for one instruction set each live in files of their own; nothing is fused but what they fuse themselves, and
# only where single precision proposes. Numbers that a search stores one by one are not to be joined into vectors: what is
# needed first would wait for the others.
$(BUILD)/src/accel/%_avx2.o: override CFLAGS += -mavx2 -mfma -mpopcnt -fno-tree-slp-vectorize
$(BUILD)/src/accel/%_avx512.o: override CFLAGS += -mavx512f -mavx512vl -mavx512dq -mavx512bw -mfma -mpopcnt -fno-tree-slp-vectorize
# No exceptions of floating-point arithmetic are looked at: without that loops with selections are not made vectors of.
$(BUILD)/src/expr/%_avx2.o: override CFLAGS += -mavx2 -fno-trapping-math
$(BUILD)/src/expr/%_avx512.o: override CFLAGS += -mavx512f -mavx512vl -mavx512dq -mavx512bw -fno-trapping-math
$(BUILD)/src/denoise/%_avx2.o: override CFLAGS += -mavx2 -fno-trapping-math
$(BUILD)/src/denoise/%_avx512.o: override CFLAGS += -mavx512f -mavx512vl -mavx512dq -mavx512bw -fno-trapping-math
# Its functions are the C library's own names: the compiler must not see calls of itself in them.
$(BUILD)/src/sandbox/libraries.o: override CFLAGS += -fno-builtin

# Tests of the release build are optimized less: they compile in half the time, and what they test is optimized as ever.
$(TEST_OBJECTS): private override CFLAGS := $(CFLAGS:-O3=-O1)
# Kernels in plain C are so long that gcc gives up telling a debugger where variables are, and says so.
$(BUILD)/tests/unit/accel/test_portable_kernel.o: private override CFLAGS += -g0

# A change of compiler or flags rebuilds everything. WERROR=1 (the tests) makes warnings errors; it is not one of the
# flags, so that make and make test share their objects. Without it a warning is shown and kept in a file beside the
# object, and WERROR=1 compiles those objects again.
FLAGS_STAMP := $(BUILD)/flags
COMPILE = $(CC) $(CPPFLAGS) $(CFLAGS) -MMD -MP -MT $@ -c
ifeq ($(config),clang)
# Only read: the object is an empty file that says when.
$(BUILD)/%.o: %.c $(FLAGS_STAMP)
	@mkdir -p $(@D)
	$(call say,CHECK,$<)
	$(Q)$(COMPILE) $(if $(WERROR),-Werror) -MF $(@:.o=.d) $< && touch $@
else ifneq ($(WERROR),)
$(foreach warned,$(shell find $(BUILD) -name '*.warned' 2>/dev/null),$(shell rm -f $(warned) $(warned:.warned=.o)))
$(BUILD)/%.o: %.c $(FLAGS_STAMP)
	@mkdir -p $(@D)
	$(call say,CC,$<)
	$(Q)$(COMPILE) -Werror -o $@ $<
else
$(BUILD)/%.o: %.c $(FLAGS_STAMP)
	@mkdir -p $(@D)
	$(call say,CC,$<)
	$(Q)$(COMPILE) -o $@ $< 2>$(@:.o=.warned); status=$$?; cat $(@:.o=.warned) >&2; \
	    [ -s $(@:.o=.warned) ] || rm -f $(@:.o=.warned); exit $$status
endif
# The file NAME.lua is the constant NAME_lua, its lines; NAME.txt is NAME_txt, the entries of its lines, which tabs divide,
# without lines of comments. A check that only reads makes no object.
STRINGS.lua = s/[\\"]/\\&/g; s/.*/"&\\n",/
STRINGS.txt = /^\#/d; s/[\\"]/\\&/g; s/\t/", "/g; s/.*/"&",/
$(EMBEDDED_OBJECTS): $(BUILD)/%.o: % $(FLAGS_STAMP)
	@mkdir -p $(@D)
	$(call say,CC,$<)
	$(Q){ echo 'const char *const $(subst .,_,$(notdir $<))[] = {'; sed '$(STRINGS$(suffix $<))' $<; echo '0};'; } >$(@:.o=.c)
	$(Q)$(CC) $(CFLAGS) -c -o $@ $(@:.o=.c) && touch $@
$(FLAGS_STAMP): force
	@mkdir -p $(@D)
	@echo '$(CC) $(CPPFLAGS) $(CFLAGS)' | cmp -s - $@ || echo '$(CC) $(CPPFLAGS) $(CFLAGS)' > $@

build-tests: $(BUILD)/gray $(BUILD)/tests/run

# Nothing is built; what clang has read without a complaint is read again when it, a header or a flag has changed.
ifeq ($(config),clang)
read-sources: $(ALL_OBJECTS)
	@echo "clang: $(words $(ALL_OBJECTS)) files"
endif
# Files whose text depends on the optional libraries.
PLAIN_SOURCES := $(if $(PLAIN),$(shell grep -l 'HAVE_' $(filter-out $(MPI_MAIN) $(GUI_SOURCES),$(SOURCES))))
read-sources-plain: $(patsubst %.c,$(BUILD)/%.o,$(PLAIN_SOURCES))
	@echo "clang: $(words $^) files without the optional libraries"
check-clang:
	@$(MAKE) -s $(JOBS) config=clang BUILD=$(call beside,clang) WERROR=1 read-sources
	@$(MAKE) -s $(JOBS) config=clang PLAIN=1 BUILD=$(call beside,clang-plain) WERROR=1 read-sources-plain

help:
	@sed -n 's/^# \{0,1\}//p; /^$$/q; /^config/q' Makefile

test check:
	@tools/test.sh
test-fast: check-libraries
	@$(MAKE) -s $(JOBS) $(BUILD)/tests/run
	@$(BUILD)/tests/run --fast -j $(shell nproc 2>/dev/null || echo 2)
# What needs a card; without one, a line says why nothing was tested.
test-gpu: gpu build-tests
	@if problem=$$($(BUILD)/gray --device gpu -q --integrator path --size 16x12 --spp 1 -o /dev/null docs/first.lua 2>&1); then \
		GRAY_TEST_DEVICE=gpu $(BUILD)/tests/run --long device_process threads_in_every parts_frames_and_resumed a_fault_of_a_function; \
	else \
		echo "test-gpu: nothing was tested: $$(echo "$$problem" | head -n 1)"; \
	fi
test-long:
	@tools/test.sh --long $(ONLY)
coverage:
	@tools/coverage.sh $(COVERAGE)
layers:
	@tools/layers.sh && tools/names.sh && tools/sizes.sh
FUZZ_SECONDS ?= 60
FUZZ ?= $(patsubst tests/fuzz/fuzz_%.c,%,$(FUZZ_SOURCES))
ifneq ($(filter $(config),fuzz afl),)
FUZZERS := $(patsubst %,$(BUILD)/fuzz_%,$(FUZZ))
$(FUZZERS): $(BUILD)/fuzz_%: $(BUILD)/tests/fuzz/fuzz_%.o $(FUZZ_HELP) $(OBJECTS)
	$(call say,LINK,$@)
	$(Q)$(CC) $(CFLAGS) -fsanitize=fuzzer $(LDFLAGS) -o $@ $^ $(LDLIBS)
build-fuzz: $(FUZZERS)
# Kernels are loops over lanes, all inlined: AFL's counters triple the minutes that they take to compile and tell it
# nothing that a fuzzer could use. The sanitizers stay.
ifeq ($(config),afl)
$(BUILD)/src/accel/triangle_kernel_%.o $(BUILD)/src/accel/triangle_packet_%.o: CC = clang
endif
endif
fuzz:
	@$(MAKE) -s $(JOBS) config=fuzz BUILD=$(call beside,fuzz) FUZZ='$(FUZZ)' build-fuzz
	@tools/fuzz.sh libfuzzer $(FUZZ_SECONDS) $(FUZZ)
fuzz-afl:
	@$(MAKE) -s $(JOBS) config=afl BUILD=$(call beside,afl) FUZZ='$(FUZZ)' build-fuzz
	@tools/fuzz.sh afl $(FUZZ_SECONDS) $(FUZZ)
# Embree, where it is installed, is the peer of the ray benchmark; the program itself never uses it.
HAVE_EMBREE := $(shell $(CC) -fsyntax-only -include embree3/rtcore.h -x c /dev/null >/dev/null 2>&1 && echo yes)
$(BUILD)/bench/rays: $(BUILD)/bench/rays.o $(BUILD)/bench/rays_scenes.o $(OBJECTS)
	$(call say,LINK,$@)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(if $(HAVE_EMBREE),-lembree3) $(LDLIBS)
$(BUILD)/bench/rays.o: private override CPPFLAGS += $(if $(HAVE_EMBREE),-DHAVE_EMBREE)

$(BUILD)/bench/growth: $(BUILD)/bench/growth.o $(BUILD)/bench/rays_scenes.o $(OBJECTS)
	$(call say,LINK,$@)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(LDLIBS)

# Other machines and libraries.
ARM_CC ?= aarch64-linux-gnu-gcc
arm:
	@$(MAKE) $(JOBS) CC='$(ARM_CC)' BUILD=$(call beside,arm) check-libraries $(call beside,arm)/gray
# The libraries are those of tools/musl_libraries.sh; headers of the kernel are the machine's.
MUSL ?= build/musl-libraries
musl:
	@$(MAKE) $(JOBS) CC='musl-gcc -idirafter /usr/include -idirafter /usr/include/$(MACHINE)-linux-gnu' LDFLAGS=-static \
	    PKG_CONFIG='env PKG_CONFIG_LIBDIR=$(abspath $(MUSL))/lib/pkgconfig pkg-config --static' BUILD=$(call beside,musl) \
	    check-libraries $(call beside,musl)/gray
test-arm test-musl: test-%:
	@tools/test_target.sh $*
scan-device:
	@tools/device_scan.sh
gpu: all
	@KERNELS=$(abspath $(BUILD))/gray-kernels tools/device_scan.sh

bench: all
	@bench/run.sh
format:
	clang-format -i $(SOURCES) $(wildcard src/*/*.h tests/*.[ch] tests/unit/*.[ch] tests/unit/*/*.[ch] tests/fuzz/*.[ch])

# What install writes, below DESTDIR and PREFIX: trees of files, and files with the folder and name that others expect.
TO = $(DESTDIR)$(PREFIX)
PROGRAMS = gray $(if $(GTK_LIBS),gray-gui) $(if $(MPI_LIBS),gray-mpi)
SHARED = $(shell find lua data textures -type f 2>/dev/null)
DOCUMENTS = $(shell find docs -type f 2>/dev/null) $(wildcard *.md) LICENSE
COMPLETIONS = share/bash-completion/completions/gray share/zsh/site-functions/_gray share/fish/vendor_completions.d/gray.fish
DESKTOP = $(if $(GTK_LIBS),share/applications/gray.desktop share/mime/packages/gray.xml)
PAGES = share/man/man1/gray.1 share/man/man5/gray-scene.5
INSTALLED = $(PROGRAMS:%=bin/%) $(SHARED:%=share/gray/%) $(DOCUMENTS:%=share/doc/gray/%) $(COMPLETIONS) $(DESKTOP) $(PAGES)
install: all
	install -d $(sort $(dir $(INSTALLED:%=$(TO)/%)))
	install -m 755 $(PROGRAMS:%=$(BUILD)/%) $(TO)/bin
	@cp --parents $(SHARED) $(TO)/share/gray && chmod 644 $(SHARED:%=$(TO)/share/gray/%)
	@cp --parents $(DOCUMENTS) $(TO)/share/doc/gray && chmod 644 $(DOCUMENTS:%=$(TO)/share/doc/gray/%)
	@for page in $(PAGES); do name=$${page##*/}; $(BUILD)/gray --roff $${name%.*} >$(TO)/$$page || exit 1; done
	install -m 644 tools/completion/gray.bash $(TO)/share/bash-completion/completions/gray
	install -m 644 tools/completion/_gray $(TO)/share/zsh/site-functions
	install -m 644 tools/completion/gray.fish $(TO)/share/fish/vendor_completions.d
	$(if $(DESKTOP),install -m 644 tools/desktop/gray.desktop $(TO)/share/applications)
	$(if $(DESKTOP),install -m 644 tools/desktop/gray.xml $(TO)/share/mime/packages)
	@$(REFRESH)

# Folders go when nothing else is in them.
uninstall:
	@rm -f $(INSTALLED:%=$(TO)/%)
	@find $(TO)/share/gray $(TO)/share/doc/gray -depth -type d -exec rmdir --ignore-fail-on-non-empty {} + 2>/dev/null; true
	@rmdir --ignore-fail-on-non-empty $(sort $(dir $(COMPLETIONS:%=$(TO)/%) $(DESKTOP:%=$(TO)/%) $(PAGES:%=$(TO)/%))) \
	    $(addprefix $(TO)/share/,bash-completion zsh fish mime doc) 2>/dev/null; true
	@$(REFRESH)
# The database of file types knows the new one, if this machine keeps one there.
REFRESH = [ -n "$(DESTDIR)" ] || [ ! -e $(TO)/share/mime/mime.cache ] || update-mime-database $(TO)/share/mime

# A folder that the caller names may hold other files.
BUILT = src tests bench gray gray-gui gray-mpi lua fuzz_* test.log raw fuzz afl clang clang-plain asan tsan debug coverage arm musl musl-libraries flags
clean:
ifdef BUILD_GIVEN
	test ! -f $(FLAGS_STAMP) || rm -rf $(addprefix $(BUILD)/,$(BUILT))
else
	rm -rf build gray rt
endif

force:
.PHONY: arm musl test-arm test-musl scan-device gpu all help check-libraries build-tests check-clang read-sources read-sources-plain test check test-fast test-long test-gpu coverage layers bench format install uninstall clean force build-fuzz fuzz fuzz-afl
-include $(ALL_OBJECTS:.o=.d) $(wildcard $(BUILD)/bench/*.d)
