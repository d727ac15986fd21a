!> How uneven the pressure of node to segment is where facets do not match.
!>
!> Slave nodes hand their forces to the master nodes opposite. A uniform pressure then gives a
!> master node l the force sum_j N_lj A_j, not its share A_l (the patch test, Taylor and
!> Papadopoulos 1991). The rest r must come from both bodies: the slave follows the master at its
!> nodes, u_s = N^T u_m, and their surfaces resist (lopin_surface_stiffness),
!>
!>    (K_m + N K_s N^T) u_m = -r,   deviation of the slave's forces  K_s N^T u_m.
!>
!> Of a large surface a window of some hundred nodes is looked at.
module lopin_uneven_pressure
   use lopin_kinds, only : wp
   use lopin_dense, only : cholesky, cholesky_solve
   use lopin_error, only : error_type, log_type, severity
   use lopin_facets, only : facet_rule_type, new_facet_rules
   use lopin_feature, only : projection_type, limits_type
   use lopin_model, only : model_type, surface_of, kind_of
   use lopin_search, only : tree_type, build_tree, find_projections
   use lopin_surface, only : surface_type
   use lopin_surface_material, only : extreme_moduli
   use lopin_surface_stiffness, only : surface_stiffness
   use lopin_text, only : to_text
   implicit none
   private
   public :: warn_of_uneven_pressure

   !> Unevenness that is said; more than this may open the contact.
   real(wp), parameter :: noticeable = 0.02_wp, all_of_it = 1.0_wp
   !> Nodes of one side in a window.
   integer, parameter :: most = 160
   !> Shares and lengths that count as equal.
   real(wp), parameter :: same = 1.0e-6_wp

contains

   !> Warn of a pair whose contact is at the nodes, both sides meshes of linear facets.
   subroutine warn_of_uneven_pressure(model, pair, slave, master, found, log)
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      type(surface_type), intent(in) :: slave, master
      type(projection_type), intent(in) :: found(:)    !! (slave%nnode) opposite each
      type(log_type), intent(inout) :: log
      real(wp) :: stiffness(2), unused, uneven

      associate (p => model%pair(pair), s => model%surface(model%pair(pair)%slave), &
         & m => model%surface(model%pair(pair)%master))
         if (slave%facets%n == 0 .or. master%facets%n == 0) return
         if (maxval(found%facet) == 0) return
         if (are_matched(slave, master, found)) return
         call extreme_moduli(model, s%element, unused, stiffness(1))
         call extreme_moduli(model, m%element, stiffness(2), unused)
         if (.not. stiffness(1) > 0.0_wp .or. .not. stiffness(2) < huge(1.0_wp)) return
         uneven = deviation(model, slave, master, found, stiffness(2)/stiffness(1))
         if (uneven > noticeable) call log%say(severity%warning, 'W0333', 'pair ('//s%name// &
            & ', '//m%name//'): facets that do not match make the pressure uneven by about '// &
            & to_text(100.0_wp*min(uneven, all_of_it), 2)//' %', p%at, &
            & help='TYPE=SURFACE TO SURFACE; or the softer side with the shorter facets as slave')
      end associate
   end subroutine warn_of_uneven_pressure

   !> Every slave node lies over a node of the master, and these are all that lie between them.
   pure logical function are_matched(slave, master, found)
      type(surface_type), intent(in) :: slave, master
      type(projection_type), intent(in) :: found(:)
      real(wp) :: largest(2)
      integer :: i

      are_matched = .false.
      largest = 0.0_wp
      do i = 1, size(found)
         if (found(i)%facet == 0) cycle
         if (maxval(found(i)%shape) < 1.0_wp - same) return
      end do
      do i = 1, slave%nnode
         if (found(i)%facet == 0) cycle
         largest(1) = max(largest(1), maxval(slave%size(slave%ring(slave%ring_first(i): &
            & slave%ring_first(i + 1) - 1))))
         largest(2) = max(largest(2), master%size(found(i)%facet))
      end do
      are_matched = largest(1) <= largest(2)*(1.0_wp + 1.0e-3_wp)
   end function are_matched

   !> Largest deviation of a slave node's pressure from the mean.
   real(wp) function deviation(model, slave, master, found, ratio)
      type(model_type), intent(in) :: model
      type(surface_type), intent(in) :: slave, master
      type(projection_type), intent(in) :: found(:)
      real(wp), intent(in) :: ratio                    !! of moduli, master over slave
      type(facet_rule_type) :: rules(6)
      integer :: of_slave(slave%nnode), of_master(master%nnode), n(2), status(2), i
      real(wp), allocatable :: ks(:, :), km(:, :), as(:), am(:), share(:, :), r(:), force(:)
      logical :: axisymmetric
      logical, allocatable :: counted(:)

      deviation = 0.0_wp
      call new_facet_rules(rules)
      axisymmetric = model%kind == kind_of%axisymmetric
      call choose_window(slave, master, model%mesh%x, found%facet > 0, of_slave, of_master)
      n = [maxval(of_slave), maxval(of_master)]
      if (any(n < 2)) return
      allocate (ks(n(1), n(1)), km(n(2), n(2)), as(n(1)), am(n(2)))
      call surface_stiffness(slave, rules, model%mesh%x, axisymmetric, of_slave, ks, as, status(1))
      call surface_stiffness(master, rules, model%mesh%x, axisymmetric, of_master, km, am, &
         & status(2))
      if (any(status /= 0)) return
      call find_shares(master, found, of_slave, of_master, share)
      counted = covered_nodes(slave, master, model%mesh%x, of_slave, of_master)
      r = matmul(share, as) - am
      where (.not. counted) r = 0.0_wp
      where (counted) r = r - am*sum(r)/sum(pack(am, counted))
      km = ratio*km + matmul(share, matmul(ks, transpose(share)))
      ! Both together may move: that does no work.
      do i = 1, n(2)
         km(:, i) = km(:, i) + am*am(i)/sum(am)**2*maxval([(km(i, i), i=1, n(2))])
      end do
      call cholesky(km, status(1))
      if (status(1) /= 0) return
      r = -r
      call cholesky_solve(km, r)
      force = matmul(ks, matmul(transpose(share), r))
      deviation = maxval(abs(force)/as)
   end function deviation

   !> All nodes of both sides, or those nearest to the middle of what is opposite.
   subroutine choose_window(slave, master, x, meets, of_slave, of_master)
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: x(:, :)
      logical, intent(in) :: meets(:)
      integer, intent(out) :: of_slave(:), of_master(:)
      real(wp) :: middle(size(x, 1)), radius
      real(wp) :: from_slave(slave%nnode), from_master(master%nnode)
      integer :: i

      middle = 0.0_wp
      do i = 1, slave%nnode
         if (meets(i)) middle = middle + x(:, slave%node(i))/count(meets)
      end do
      from_slave = [(norm2(x(:, slave%node(i)) - middle), i=1, slave%nnode)]
      from_master = [(norm2(x(:, master%node(i)) - middle), i=1, master%nnode)]
      radius = huge(1.0_wp)
      if (max(slave%nnode, master%nnode) > most) then
         radius = max(maxval(from_slave), maxval(from_master))
         do while (max(count(from_slave <= radius), count(from_master <= radius)) > most)
            radius = 0.95_wp*radius
         end do
      end if
      call number_inside(slave, from_slave <= radius, of_slave)
      call number_inside(master, from_master <= radius, of_master)
   end subroutine choose_window

   !> Numbers of the nodes that belong to facets wholly inside.
   pure subroutine number_inside(surface, inside, place)
      type(surface_type), intent(in) :: surface
      logical, intent(in) :: inside(:)
      integer, intent(out) :: place(:)
      integer :: i, n

      place = 0
      do i = 1, surface%facets%n
         n = surface%facets%nnode(i)
         if (all(inside(surface%local(:n, i)))) place(surface%local(:n, i)) = 1
      end do
      n = 0
      do i = 1, size(place)
         if (place(i) == 0) cycle
         n = n + 1
         place(i) = n
      end do
   end subroutine number_inside

   !> N: shares of the master nodes at the places of the slave nodes.
   subroutine find_shares(master, found, of_slave, of_master, share)
      type(surface_type), intent(in) :: master
      type(projection_type), intent(in) :: found(:)
      integer, intent(in) :: of_slave(:), of_master(:)
      real(wp), allocatable, intent(out) :: share(:, :)
      integer :: i, k, at

      allocate (share(maxval(of_master), maxval(of_slave)), source=0.0_wp)
      do i = 1, size(of_slave)
         if (of_slave(i) == 0 .or. found(i)%facet == 0) cycle
         do k = 1, master%facets%nnode(found(i)%facet)
            at = of_master(master%local(k, found(i)%facet))
            if (at > 0) share(at, of_slave(i)) = share(at, of_slave(i)) + found(i)%shape(k)
         end do
      end do
   end subroutine find_shares

   !> Master nodes whose facets all lie over facets of the slave inside the window.
   function covered_nodes(slave, master, x, of_slave, of_master) result(counted)
      type(surface_type), intent(in) :: slave, master
      real(wp), intent(in) :: x(:, :)
      integer, intent(in) :: of_slave(:), of_master(:)
      logical :: counted(maxval(of_master)), over(master%nnode)
      type(tree_type) :: tree
      type(limits_type) :: limits
      type(projection_type) :: found(master%nnode)
      integer :: i, n

      call build_tree(tree, slave%low, slave%high)
      limits%extension = 1.0e-3_wp
      call find_projections(slave, tree, x(:, master%node), master%pseudo(:size(x, 1), :), limits, &
         & found)
      over = found%facet > 0 .and. of_master > 0
      do i = 1, master%nnode
         if (.not. over(i)) cycle
         n = slave%facets%nnode(found(i)%facet)
         over(i) = all(of_slave(slave%local(:n, found(i)%facet)) > 0)
      end do
      counted = .true.
      do i = 1, master%facets%n
         n = master%facets%nnode(i)
         if (all(over(master%local(:n, i)))) cycle
         associate (at => of_master(master%local(:n, i)))
            counted(pack(at, at > 0)) = .false.
         end associate
      end do
   end function covered_nodes
end module lopin_uneven_pressure
