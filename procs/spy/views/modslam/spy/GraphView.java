// SPDX-License-Identifier: BSD-3-Clause
package modslam.spy;

import java.awt.Color;
import java.awt.Graphics2D;
import java.awt.geom.Line2D;
import java.util.Map;
import java.util.TreeMap;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import lcm.lcm.LCMDataInputStream;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;
import modslam.graph_edge_t;
import modslam.graph_node_t;
import modslam.graph_update_t;
import modslam.node_pose_t;

/** Nodes and edges since the window was opened; loops in another colour. */
public class GraphView implements SpyPlugin {
    @Override public boolean canHandle(long fingerprint) {
        return fingerprint == graph_update_t.LCM_FINGERPRINT || fingerprint == graph_node_t.LCM_FINGERPRINT;
    }
    @Override public Action getAction(JDesktopPane desktop, ChannelData channel) {
        return MapPanel.window("Pose graph", "NODE|GRAPH", Panel::new);
    }

    static class Panel extends MapPanel {
        private final Map<Long, double[]> nodes = new TreeMap<>();
        private final Map<Long, graph_edge_t> edges = new TreeMap<>();
        @Override void take(String channel, LCMDataInputStream bytes) throws Exception {
            if (channel.equals("NODE")) {
                graph_node_t node = new graph_node_t(bytes);
                if (node.id == 0) { nodes.clear(); edges.clear(); seeAnew(); }
                put(node.id, node.T_map_base);
                return;
            }
            graph_update_t update = new graph_update_t(bytes);
            if (update.snapshot && update.chunk == 0) edges.clear();
            for (graph_edge_t edge : update.edges) edges.put(edge.id, edge);
            for (long id : update.retracted) edges.remove(id);
            for (node_pose_t pose : update.poses) put(pose.id, pose.T_map_base);
        }
        private void put(long id, double[] pose) { nodes.put(id, pose); see(pose[0], pose[1]); }
        @Override void draw(Graphics2D g) {
            for (graph_edge_t edge : edges.values()) {
                double[] a = nodes.get(edge.from_node), b = nodes.get(edge.to_node);
                if (a == null || b == null) continue;
                boolean loop = edge.kind == graph_edge_t.LOOP;
                g.setColor(new Color(loop ? 0xb5489a : 0x2f8f99));
                g.setStroke(width(loop ? 2 : 1));
                g.draw(new Line2D.Double(a[0], a[1], b[0], b[1]));
            }
            g.setColor(new Color(0x1f6f78));
            for (double[] node : nodes.values()) dot(g, node[0], node[1], 4);
        }
    }
}
