# Thunderhead's server. The image installs and builds by ./dev, the same script as on a developer's machine.
#   docker build -t thunderhead .
#   docker run --rm -p 127.0.0.1:8080:8080 -v /path/to/storms:/data:ro thunderhead
# The server renders in software. With the NVIDIA container runtime (--gpus all) it renders on the GPU, by the driver's
# own EGL.
FROM debian:bookworm-slim AS build
WORKDIR /src
# The packages are in a separate layer, so that a change of the code does not install them again.
COPY dev ./
COPY deploy/packages deploy/packages
RUN ./dev install runtime build web && rm -rf /var/lib/apt/lists/*
COPY . .
RUN ./dev build release \
    && strip build/release/bin/thunderhead build/release/bin/thunderhead-reader build/release/bin/thunderhead-vdb-reader \
        build/release/lib/thunderhead/vdb-writer.so

FROM debian:bookworm-slim
WORKDIR /opt/thunderhead
COPY dev ./
COPY deploy/packages deploy/packages
RUN ./dev install runtime && rm -rf /var/lib/apt/lists/* dev deploy \
    && useradd --system --no-create-home thunderhead \
    && install --directory --mode=0700 --owner=thunderhead /var/lib/thunderhead
COPY --from=build /src/build/release/bin/thunderhead /src/build/release/bin/thunderhead-reader \
    /src/build/release/bin/thunderhead-vdb-reader bin/
COPY --from=build /src/build/release/lib/thunderhead lib/thunderhead/
COPY --from=build /src/client-web/dist share/thunderhead/page/
COPY --from=build /src/build/release/packaging/third-party-notices.txt share/doc/
COPY --from=build /src/samples/supercell-500m.nc /data/
ENV PATH=/opt/thunderhead/bin:$PATH \
    NVIDIA_DRIVER_CAPABILITIES=graphics,utility \
    STATE_DIRECTORY=/var/lib/thunderhead
USER thunderhead
EXPOSE 8080 50051
# The server must listen on all addresses of the container, and --insecure allows this without tokens and TLS. The
# published ports decide who can reach the server. To publish it to other machines, give --auth, --tls-cert and
# --tls-key instead: docs/operating.md.
ENTRYPOINT ["thunderhead"]
CMD ["serve", "--data", "/data", "--http", "0.0.0.0:8080", "--grpc", "0.0.0.0:50051", "--insecure"]
