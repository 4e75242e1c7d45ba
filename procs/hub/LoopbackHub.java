// SPDX-License-Identifier: BSD-3-Clause
package lcm.lcm;

import java.io.IOException;
import java.lang.reflect.Field;
import java.net.InetAddress;
import java.net.ServerSocket;
import java.net.Socket;
import java.util.ArrayList;
import java.util.concurrent.locks.ReentrantReadWriteLock;

/**
 * LoopbackHub PORT: LCM's TCP hub, bound to 127.0.0.1.
 *
 * <p>The hub of lcm.jar listens on every interface, and its constructor both opens the socket and never returns. So it is made
 * here without its constructor and given a socket that only this machine reaches. Small send buffers keep a fast player from running
 * megabytes ahead of a slow listener; without them messages wait for each other (Nagle) 40 ms at a time.
 */
final class LoopbackHub {
  private static final int SEND_BUFFER = 64 << 10;

  private static final class LoopbackSocket extends ServerSocket {
    LoopbackSocket(int port) throws IOException {
      super(port, 50, InetAddress.getLoopbackAddress());
    }

    @Override
    public Socket accept() throws IOException {
      Socket client = super.accept();
      client.setSendBufferSize(SEND_BUFFER);
      client.setTcpNoDelay(true);
      return client;
    }
  }

  private LoopbackHub() {}

  public static void main(String[] words) throws Exception {
    Field field = sun.misc.Unsafe.class.getDeclaredField("theUnsafe");
    field.setAccessible(true);
    TCPService hub = (TCPService) ((sun.misc.Unsafe) field.get(null)).allocateInstance(TCPService.class);
    hub.clients = new ArrayList<>();
    hub.clients_lock = new ReentrantReadWriteLock();
    hub.serverSocket = new LoopbackSocket(Integer.parseInt(words[0]));
    hub.new AcceptThread().run();
  }
}
