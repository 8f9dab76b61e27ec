"""What rclpy and DDS lack or get wrong, each mended in one place.

Seen with rclpy 7.1.6 and Fast DDS of ROS 2 Jazzy. A line goes, with what mends it, once the
release that is pinned does what it should.

========================================================== ==================== ================
What is wrong                                              Mended by            Upstream issue
========================================================== ==================== ================
A coroutine that waits keeps the events executor busy      ``executor``         rclpy 1405
A task that is cancelled is called for ever                ``executor``
A task that raises ends the process with SIGSEGV           ``executor``         rclpy 1641
``spin_once`` without a timeout spins and fires no timer   ``executor``
Errors of the middleware have no public name               ``executor``
Nine timers of a node, or one set anew, flood the executor ``timers``
No sleep, and no deadline for an awaited future            ``awaitables``
An asynchronous service callback is not awaited            ``deferred_service`` rclpy 1473
No call from another thread that waits for its result      ``main_thread``
Event handlers of what is destroyed end in SIGSEGV         ``node``             rclpy 1644
A callback group remembers each subscription that ever was ``node``             rclpy 1356
The state of a lifecycle node has no public name           ``node``
Actions of a node that is destroyed are left alive         ``node``
Its service for transitions cannot be refused              ``node``
Goals of an action server are kept for good                ``action_server``
Only an executor can empty a subscription                  ``subscription``
Logging looks at files, and raises at a second severity    ``log``
A reader does not follow what its publishers offer         ``qos``
Shared memory hangs when a process dies while it sends     ``middleware``       rmw_fastrtps 908
LOCALHOST answers a neighbour that names us as its peer    ``middleware``
========================================================== ==================== ================

``messages`` and ``topic`` mend nothing: they turn messages into plain data, and topics as recipes
write them into what rclpy takes.
"""
