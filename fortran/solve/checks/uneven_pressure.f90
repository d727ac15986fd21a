!> How uneven the pressure of node to segment is where facets do not match.
!>
!> Slave nodes hand their forces to the master nodes opposite. A uniform pressure then gives the
!> master H A, not the forces c that its shape functions make of it (the patch test, Taylor and
!> Papadopoulos 1991). What is wrong comes from both bodies: with the rows H^T u = 0 of the gaps
!>
!>    K u = H (A + d) - c,   deviation of the slave's forces  d,
!>
!> solved with the stiffness K of the run itself near the contact, all farther nodes held, the rows
!> by stiff springs. Of a large surface a window of some hundred nodes is looked at.
!>
!> Where the slave's facets are the longer ones, nodes of the master lie between its nodes and have
!> no force (H A) where a uniform pressure would give them c: stresses of the elements behind are
!> uneven, whatever the slave's pressures are.
module lopin_uneven_pressure
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_type
   use lopin_constraints, only : constraints_type, new_constraints
   use lopin_contact_patch, only : patch_type, new_patch, solve_patch
   use lopin_element_type, only : cells_of_words
   use lopin_error, only : error_type, severity
   use lopin_model, only : model_type, pair_type, surface_of
   use lopin_flat_elements, only : is_ring
   use lopin_mortar_pairs, only : is_mortar, shape_of
   use lopin_scene, only : scene_type
   use lopin_surface, only : surface_type
   use lopin_text, only : to_text
   use lopin_uniform_pressure, only : share_pressure
   implicit none
   private
   public :: warn_of_uneven_pressure, unevenness, is_at_nodes, noticeable, all_of_it

   !> Unevenness that is said; more than this may open the contact.
   real(wp), parameter :: noticeable = 0.02_wp, all_of_it = 1.0_wp
   !> Nodes of one side in a window.
   integer, parameter :: most_in_plane = 160, most_in_space = 64
   !> Largest deviation of stresses at the points of the master's first elements by that of its
   !> forces H A - c, in the plane and in space: .22 to .35 and .5 to .95 were measured for bricks,
   !> wedges and simplices under slaves 1.15 to 4 times as coarse, and what of them is said.
   real(wp), parameter :: of_stress(2) = [0.3_wp, 0.7_wp], noticeable_stress = 0.05_wp
   !> Shares and lengths that count as equal.
   real(wp), parameter :: same = 1.0e-6_wp

contains

   !> Warn of the pairs whose contact is at the nodes, both sides meshes.
   subroutine warn_of_uneven_pressure(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp) :: uneven(size(model%pair)), on_master(size(model%pair))
      integer :: pair

      uneven = unevenness(scene, model, spread(.true., 1, size(model%pair)), on_master)
      do pair = 1, size(model%pair)
         associate (p => model%pair(pair))
            on_master(pair) = of_stress(model%mesh%ndim - 1)*on_master(pair)
            if (on_master(pair) > noticeable_stress) call scene%log%say(severity%warning, 'W0348', &
               & 'pair ('//model%surface(p%slave)%name//', '//model%surface(p%master)%name// &
               & '): the facets of the slave are longer and press the master at single nodes: '// &
               & 'stresses beside its surface are uneven by about '// &
               & to_text(100.0_wp*on_master(pair), 2)//' %', p%at, help= &
               & 'TYPE=SURFACE TO SURFACE; or the side with the shorter facets as slave')
            if (.not. uneven(pair) > noticeable) cycle
            call scene%log%say(severity%warning, 'W0333', 'pair ('//model%surface(p%slave)%name// &
               & ', '//model%surface(p%master)%name// &
               & '): facets that do not match make the pressure uneven by about '// &
               & to_text(100.0_wp*min(uneven(pair), all_of_it), 2)//' %', p%at, help= &
               & 'TYPE=SURFACE TO SURFACE; or the softer side with the shorter facets as slave')
         end associate
      end do
   end subroutine warn_of_uneven_pressure

   !> Largest deviation of a slave node's pressure from the mean; -1 where it is even and the slave
   !> no coarser than the master, where contact is not at the nodes of a mesh on another, and where
   !> it is not wanted.
   function unevenness(scene, model, wanted, on_master) result(uneven)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      logical, intent(in) :: wanted(:)             !! (pairs)
      real(wp), intent(out), optional :: on_master(:)   !! (pairs) of forces of the master
      real(wp) :: uneven(size(model%pair)), of_master
      type(constraints_type) :: constraints
      type(cell_type), allocatable :: cells(:)
      type(surface_type) :: slave, master
      type(error_type), allocatable :: error
      integer :: pair

      uneven = -1.0_wp
      if (present(on_master)) on_master = 0.0_wp
      do pair = 1, size(model%pair)
         associate (p => model%pair(pair), first => scene%points%first(pair), &
            & last => scene%points%first(pair + 1) - 1)
            if (.not. (wanted(pair) .and. is_at_nodes(model, p))) cycle
            if (.not. any(scene%points%facet(first:last) > 0)) cycle
            if (.not. allocated(cells)) call cells_of_words(model%element_word, cells)
            call shape_of(slave, model, cells, p%slave, error)
            if (.not. allocated(error)) call shape_of(master, model, cells, p%master, error)
            if (allocated(error)) return
            if (are_matched(slave, master, scene%points%facet(first:last), &
               & scene%points%shape(:, first:last))) cycle
            ! What is wrong with the supports is said where the first step begins.
            if (.not. allocated(constraints%first)) call new_constraints(constraints, model, &
               & scene%dofs, model%step(1), error)
            if (allocated(error)) return
            call find_deviation(uneven(pair), of_master, scene, model, constraints, pair, slave, &
               & master)
            if (is_coarser(slave, master, scene%points%facet(first:last))) then
               if (present(on_master)) on_master(pair) = of_master
            else if (uneven(pair) <= noticeable) then
               uneven(pair) = -1.0_wp
            end if
         end associate
      end do
   end function unevenness

   !> Two meshes, one at the nodes of the other.
   pure logical function is_at_nodes(model, pair)
      type(model_type), intent(in) :: model
      type(pair_type), intent(in) :: pair

      is_at_nodes = pair%slave /= pair%master .and. .not. is_mortar(model, pair) .and. all( &
         & model%surface([pair%slave, pair%master])%kind == surface_of%faces)
   end function is_at_nodes

   !> Every slave node lies over a node of the master, and these are all that lie between them.
   pure logical function are_matched(slave, master, facet, shape)
      type(surface_type), intent(in) :: slave, master
      integer, intent(in) :: facet(:)              !! (slave%nnode) opposite; 0: none
      real(wp), intent(in) :: shape(:, :)          !! (8 or more, slave%nnode)
      integer :: i

      are_matched = .false.
      do i = 1, slave%nnode
         if (facet(i) == 0) cycle
         if (maxval(shape(:, i)) < 1.0_wp - same) return
      end do
      are_matched = .not. is_coarser(slave, master, facet)
   end function are_matched

   !> The largest facets of the slave that touch are larger than those of the master: nodes of the
   !> master lie between its nodes.
   pure logical function is_coarser(slave, master, facet)
      type(surface_type), intent(in) :: slave, master
      integer, intent(in) :: facet(:)              !! (slave%nnode) opposite; 0: none
      real(wp) :: largest(2)
      integer :: i

      largest = 0.0_wp
      do i = 1, slave%nnode
         if (facet(i) == 0) cycle
         largest(1) = max(largest(1), maxval(slave%size(slave%ring(slave%ring_first(i): &
            & slave%ring_first(i + 1) - 1))))
         largest(2) = max(largest(2), master%size(facet(i)))
      end do
      is_coarser = largest(1) > largest(2)*(1.0_wp + 1.0e-3_wp)
   end function is_coarser

   !> Largest deviation of a slave node's pressure from the mean, and of a master node's force.
   subroutine find_deviation(deviation, of_master, scene, model, constraints, pair, slave, master)
      real(wp), intent(out) :: deviation, of_master
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: pair
      type(surface_type), intent(in) :: slave, master
      type(patch_type) :: patch
      logical :: inside(slave%nnode), met(master%facets%n), counted(slave%nnode)
      real(wp) :: force(model%mesh%ndim, model%mesh%nnode), area(slave%nnode)
      real(wp), allocatable :: wrong(:), more(:)
      integer, allocatable :: facet(:), local(:), point(:)
      integer :: i

      deviation = 0.0_wp
      of_master = 0.0_wp
      associate (points => scene%points, before => scene%points%first(pair) - 1)
         inside = window(slave, master, model%mesh%x, points%facet(before + 1: &
            & before + slave%nnode) > 0)
         facet = pack([(i, i=1, slave%facets%n)], facets_inside(slave, inside))
         if (size(facet) == 0) return
         force = 0.0_wp
         call share_pressure(slave, facet, master, is_ring(model, model%pair(pair)%slave), &
            & force, area, met)
         local = pack([(i, i=1, slave%nnode)], area > 0.0_wp .and. points%facet(before + 1: &
            & before + slave%nnode) > 0)
         point = before + local
         wrong = [(area(local(i)) - dot_product(force(:, slave%node(local(i))), &
            & points%normal(:size(force, 1), point(i))), i=1, size(local))]
         call new_patch(patch, scene, model, constraints, point, [slave%node(pack([(i, i=1, &
            & slave%nnode)], area > 0.0_wp)), nodes_of(master, met)])
         call solve_patch(patch, scene, constraints, area(local), -force, more)
         if (.not. allocated(more)) return
         counted = far_from_rim(slave, facets_inside(slave, inside))
         ! In space the window may hold no node far from its rim of a slave that is much coarser.
         if (any(counted(local)) .or. size(force, 1) == 2) deviation = &
            & maxval(abs(wrong + more)/area(local), mask=counted(local))
         of_master = forced(scene, master, met, force, area(local), point)
      end associate
   end subroutine find_deviation

   !> Largest deviation of the forces that slave nodes hand to the master from those of a uniform
   !> pressure, beside these: of nodes that no facet at the rim has, on facets of first order.
   pure real(wp) function forced(scene, master, met, force, area, point) result(most)
      type(scene_type), intent(in) :: scene
      type(surface_type), intent(in) :: master
      logical, intent(in) :: met(:)                !! (master%facets%n)
      real(wp), intent(in) :: force(:, :)          !! (ndim, mesh nodes) of a uniform pressure
      real(wp), intent(in) :: area(:)              !! (n) of slave nodes
      integer, intent(in) :: point(:)              !! (n) their contact points
      real(wp) :: handed(size(force, 2))
      logical :: inside(master%nnode)
      integer :: i, k

      handed = 0.0_wp
      do i = 1, size(point)
         do k = 1, size(scene%points%master, 1)
            associate (node => scene%points%master(k, point(i)))
               if (node > 0) handed(node) = handed(node) + scene%points%shape(k, point(i))*area(i)
            end associate
         end do
      end do
      inside = far_from_rim(master, met .and. master%facets%nnode <= 2*(size(force, 1) - 1))
      most = 0.0_wp
      do i = 1, master%nnode
         if (.not. inside(i)) cycle
         associate (even => norm2(force(:, master%node(i))))
            if (even > 0.0_wp) most = max(most, abs(handed(master%node(i))/even - 1.0_wp))
         end associate
      end do
   end function forced

   !> All nodes of the slave, or those nearest to the middle of what is opposite: few enough, with
   !> those of the master that are as near.
   pure function window(slave, master, x, meets) result(inside)
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: x(:, :)
      logical, intent(in) :: meets(:)
      logical :: inside(slave%nnode)
      real(wp) :: middle(size(x, 1)), radius
      real(wp) :: from_slave(slave%nnode), from_master(master%nnode)
      integer :: i, most

      inside = .true.
      most = merge(most_in_plane, most_in_space, size(x, 1) == 2)
      if (max(slave%nnode, master%nnode) <= most) return
      middle = 0.0_wp
      do i = 1, slave%nnode
         if (meets(i)) middle = middle + x(:, slave%node(i))/count(meets)
      end do
      from_slave = [(norm2(x(:, slave%node(i)) - middle), i=1, slave%nnode)]
      from_master = [(norm2(x(:, master%node(i)) - middle), i=1, master%nnode)]
      radius = max(maxval(from_slave), maxval(from_master))
      do while (max(count(from_slave <= radius), count(from_master <= radius)) > most)
         radius = 0.95_wp*radius
      end do
      inside = from_slave <= radius
   end function window

   pure function facets_inside(slave, inside) result(used)
      type(surface_type), intent(in) :: slave
      logical, intent(in) :: inside(:)             !! (slave%nnode)
      logical :: used(slave%facets%n)
      integer :: i

      used = [(all(inside(slave%local(:slave%facets%nnode(i), i))), i=1, slave%facets%n)]
   end function facets_inside

   !> Mesh nodes of some facets.
   pure function nodes_of(surface, facet) result(node)
      type(surface_type), intent(in) :: surface
      logical, intent(in) :: facet(:)              !! (surface%facets%n)
      integer, allocatable :: node(:)
      logical :: on(surface%nnode)
      integer :: i

      on = .false.
      do i = 1, surface%facets%n
         if (facet(i)) on(surface%local(:surface%facets%nnode(i), i)) = .true.
      end do
      node = pack(surface%node, on)
   end function nodes_of

   !> Nodes that no facet outside the window has, nor any node of their facets.
   pure function far_from_rim(slave, used) result(far)
      type(surface_type), intent(in) :: slave
      logical, intent(in) :: used(:)               !! (slave%facets%n)
      logical :: far(slave%nnode), whole(slave%nnode)
      integer :: i

      whole = .true.
      do i = 1, slave%facets%n
         if (.not. used(i)) whole(slave%local(:slave%facets%nnode(i), i)) = .false.
      end do
      far = whole
      do i = 1, slave%facets%n
         associate (at => slave%local(:slave%facets%nnode(i), i))
            if (.not. all(whole(at))) far(at) = .false.
         end associate
      end do
   end function far_from_rim
end module lopin_uneven_pressure
