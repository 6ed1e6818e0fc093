# Not built yet: checked by hadolint alone.
# docker build -t wct . && docker run --rm --network none -v "$PWD:/work" wct optimize part.stl part.vtu
FROM python:3.13-slim-bookworm AS build
# hadolint ignore=DL3008
RUN apt-get update && apt-get install -y --no-install-recommends g++ && rm -rf /var/lib/apt/lists/*
WORKDIR /source
COPY . .
RUN pip wheel --no-cache-dir --no-deps --wheel-dir /wheels .

FROM python:3.13-slim-bookworm
# TetGen, and what the wheels of pymeshlab load.
# hadolint ignore=DL3008
RUN apt-get update \
    && apt-get install -y --no-install-recommends tetgen libgl1 libopengl0 libxrender1 \
    && rm -rf /var/lib/apt/lists/*
RUN --mount=type=bind,from=build,source=/wheels,target=/wheels \
    pip install --no-cache-dir "$(echo /wheels/*.whl)[report,images]"
RUN useradd --create-home --uid 1000 wct
USER 1000
WORKDIR /work
ENTRYPOINT ["wct"]
