!> Elements that are folded or about to fold, named while the results can still be trusted.
module lopin_check_mesh
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_vectors, only : largest
   use lopin_text, only : to_text
   use lopin_mesh, only : place_of_element
   use lopin_model, only : model_type
   use lopin_corner_shape, only : corners_type, new_corners, worst_corner, turns_over, shortest_side
   use lopin_report, only : certificate_type
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: check_mesh, check_corners, refuse_folded, refuse_fold, folding_at, folds

   !> Scaled Jacobian at a corner below which it is about to fold, if deformation has taken half.
   real(wp), parameter :: about_to_fold = 0.1_wp, spoiled = 0.5_wp
   !> Corners that are flat to rounding are not folded.
   real(wp), parameter :: flat = 1.0e-9_wp
   !> A side that has rolled onto a tool makes its corner flat, to the curvature of the tool: no
   !> more than a warning.
   real(wp), parameter :: rolled_flat = 1.0e-3_wp
   !> Iterations of Newton may fold corners a little on their way, as where they roll onto a tool.
   real(wp), parameter :: turned_over = 0.2_wp

   !> What is left of a side where metal has necked, how much more of the one beside it; cosine.
   real(wp), parameter :: necked = 1.0_wp/7.0_wp, wider = 3.0_wp, parallel = 0.99_wp

   !> The worst corner of a mesh.
   type :: fold_type
      integer :: element = 0, node = 0         !! 0: none
      real(wp) :: value = 1.0_wp               !! its scaled Jacobian
   end type fold_type

contains

   !> The corner with the least scaled Jacobian at displacements u, at least below `least`; with
   !> `worsened`, among those that deformation has spoiled.
   subroutine find_fold(fold, scene, model, u, least, worsened)
      type(fold_type), intent(out) :: fold
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:)             !! (ndof) [length]
      real(wp), intent(in) :: least
      logical, intent(in) :: worsened
      type(corners_type) :: corners(size(scene%solids%group))
      real(wp) :: value, before, x(model%mesh%ndim, 20), square(model%mesh%nelement)
      logical :: spared(model%mesh%nelement)   ! what turns over no corner folds none
      integer :: e, g, n, corner, first

      do g = 1, size(corners)
         call new_corners(corners(g), scene%solids%group(g)%element%cell)
      end do
      fold%value = least
      spared = .false.
      if (.not. least > 0.0_wp .and. allocated(scene%spare)) then
         call scene%spread%squares(u, square)
         spared = square < scene%spare**2
      end if
      do e = 1, model%mesh%nelement
         g = scene%solids%which(e)
         if (g == 0) cycle
         if (spared(e)) cycle
         call place_corners(scene, model, u, 1.0_wp, e, x, n)
         if (.not. least > 0.0_wp) then
            if (.not. turns_over(corners(g), x(:, :n))) cycle
         end if
         call worst_corner(corners(g), x(:, :n), value, corner)
         if (.not. value < fold%value) cycle
         if (worsened) then
            call worst_at(corners(g), scene, model, u, 0.0_wp, e, before, first)
            if (.not. value < spoiled*before) cycle
         end if
         fold = fold_type(e, model%mesh%conn(corner, e), value)
      end do
   end subroutine find_fold

   !> How far nodes may move from the first one of their element before a corner turns over.
   !>
   !> At a corner the determinant of its edges over their lengths is J. Where no node moves farther
   !> than d from the first, an edge changes by at most c d (c = 2; 8 of one with a node amid it),
   !> by r = c d/L beside the shortest length L, and the determinant by at most (1 + r)^3 - 1, which
   !> is not above 7 r where r <= 1: its sign stays where 7 c d < J L.
   subroutine find_spare(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(corners_type) :: corners(size(scene%solids%group))
      real(wp), allocatable :: none(:)
      real(wp) :: value, x(model%mesh%ndim, 20)
      integer :: e, g, n, corner

      do g = 1, size(corners)
         call new_corners(corners(g), scene%solids%group(g)%element%cell)
      end do
      allocate (none(scene%dofs%n), source=0.0_wp)
      if (allocated(scene%spare)) deallocate (scene%spare)
      allocate (scene%spare(model%mesh%nelement), source=0.0_wp)
      do e = 1, model%mesh%nelement
         g = scene%solids%which(e)
         if (g == 0) cycle
         call place_corners(scene, model, none, 1.0_wp, e, x, n)
         call worst_corner(corners(g), x(:, :n), value, corner)
         scene%spare(e) = max(value, 0.0_wp)*shortest_side(corners(g), x(:, :n)) &
            & /(7.0_wp*merge(8.0_wp, 2.0_wp, corners(g)%middle(1, 1) > 0))
      end do
   end subroutine find_spare

   !> The worst corner of an element at a share of displacements u.
   pure subroutine worst_at(corners, scene, model, u, share, e, value, corner)
      type(corners_type), intent(in) :: corners
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:)             !! (ndof) [length]
      real(wp), intent(in) :: share
      integer, intent(in) :: e
      real(wp), intent(out) :: value           !! its scaled Jacobian
      integer, intent(out) :: corner           !! its place among the nodes of the element
      real(wp) :: x(model%mesh%ndim, 20)
      integer :: n

      call place_corners(scene, model, u, share, e, x, n)
      call worst_corner(corners, x(:, :n), value, corner)
   end subroutine worst_at

   !> Where the nodes of an element are at a share of displacements u.
   pure subroutine place_corners(scene, model, u, share, e, x, n)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:)             !! (ndof) [length]
      real(wp), intent(in) :: share
      integer, intent(in) :: e
      real(wp), intent(inout) :: x(:, :)       !! (ndim, n and more) [length]
      integer, intent(out) :: n                !! nodes
      integer :: a, k

      n = scene%solids%group(scene%solids%which(e))%element%cell%nnode
      do a = 1, n
         associate (i => model%mesh%conn(a, e))
            x(:, a) = model%mesh%x(:, i)
            do k = 1, model%mesh%ndim
               if (scene%dofs%id(k, i) > 0) x(k, a) = x(k, a) + share*u(scene%dofs%id(k, i))
            end do
         end associate
      end do
   end subroutine place_corners

   !> Some corner is well inside out at displacements u: an iteration may pass flat ones.
   logical function folds(scene, model, u)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:)             !! (ndof) [length]
      type(fold_type) :: fold

      folds = .false.
      if (4.0_wp*largest(u) < scene%margin) return
      call find_fold(fold, scene, model, u, -turned_over, .false.)
      folds = fold%element > 0
   end function folds

   !> Where a mesh folds, in words; empty if it does not.
   function folding_at(scene, model, u) result(text)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:)             !! (ndof) [length]
      character(len=:), allocatable :: text
      type(fold_type) :: fold

      text = ''
      call find_fold(fold, scene, model, u, 2.0_wp*about_to_fold, .true.)
      if (fold%element == 0) return
      text = 'element '//to_text(model%mesh%element_label(fold%element))//' folds at node '// &
         & to_text(model%mesh%node_label(fold%node))//' (scaled Jacobian '// &
         & to_text(fold%value, 3)//')'
   end function folding_at

   !> A mesh with a corner that is folded before anything has moved.
   subroutine refuse_folded(scene, model, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      type(fold_type) :: fold

      call find_fold(fold, scene, model, 0.0_wp*scene%trial%motion%u, 1.0_wp, .false.)
      scene%margin = max(fold%value, 0.0_wp)*shortest_edge(model)
      call find_spare(scene, model)
      if (fold%element == 0 .or. .not. fold%value < -flat) return
      associate (e => fold%element)
         call raise(error, error_code%deck, 'E0302', 'element '// &
            & to_text(model%mesh%element_label(e))//' ('// &
            & trim(scene%solids%group(scene%solids%which(e))%element%word)// &
            & ') is folded: at node '//to_text(model%mesh%node_label(fold%node))// &
            & ' the scaled Jacobian is '//to_text(fold%value, 3), &
            & place_of_element(model%mesh, e), help='list its nodes in the order of the '// &
            & 'element, and keep nodes amid edges near their middles')
      end associate
   end subroutine refuse_folded

   !> Shortest distance of corners that follow each other in an element; 0 where they coincide.
   pure real(wp) function shortest_edge(model) result(shortest)
      type(model_type), intent(in) :: model
      integer :: e, a

      shortest = huge(1.0_wp)
      associate (mesh => model%mesh)
         do e = 1, mesh%nelement
            do a = 1, 3
               if (mesh%conn(a + 1, e) == 0) exit
               shortest = min(shortest, &
                  & norm2(mesh%x(:, mesh%conn(a + 1, e)) - mesh%x(:, mesh%conn(a, e))))
            end do
         end do
      end associate
   end function shortest_edge

   !> The worst corner of the trial state, for the certificate.
   subroutine check_corners(self, scene, model)
      type(certificate_type), intent(inout) :: self
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(fold_type) :: fold

      if (4.0_wp*largest(scene%trial%motion%u) < scene%margin) return
      call find_fold(fold, scene, model, scene%trial%motion%u, -flat, .false.)
      if (fold%element == 0) return
      ! Displacements of the small theory do not move the mesh.
      self%fold_level = merge(2, 1, scene%newton%nlgeom .and. fold%value < -rolled_flat)
      self%corner = fold%value
      self%folded = model%mesh%element_label(fold%element)
   end subroutine check_corners

   !> A balance with a corner inside out that the accepted state does not lead to: forces of a
   !> folded mesh are those of no solid, and Newton finds states among them that the path never
   !> meets.
   subroutine refuse_fold(scene, model, certificate, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(certificate_type), intent(inout) :: certificate
      type(error_type), allocatable, intent(out) :: error
      type(corners_type) :: corners
      integer :: e, corner
      real(wp) :: first, accepted

      if (.not. scene%may_cut .or. certificate%fold_level < 2) return
      e = findloc(model%mesh%element_label, certificate%folded, dim=1)
      call new_corners(corners, scene%solids%group(scene%solids%which(e))%element%cell)
      call worst_at(corners, scene, model, scene%trial%motion%u, 0.0_wp, e, first, corner)
      call worst_at(corners, scene, model, scene%accepted%motion%u, 1.0_wp, e, accepted, corner)
      if (accepted < min(about_to_fold, spoiled*first)) return
      call raise(error, error_code%not_converged, 'E0514', 'the balance found has '// &
         & 'a corner of element '//to_text(certificate%folded)//' inside out', &
         & model%step(scene%step)%at, help='smaller increments on *STATIC')
      certificate = certificate_type()
   end subroutine refuse_fold

   !> Warn once a step of the worst corner of the accepted displacements.
   subroutine check_mesh(scene, model, increment)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: increment
      type(fold_type) :: fold
      character(len=:), allocatable :: help

      call find_fold(fold, scene, model, scene%trial%motion%u, about_to_fold, .true.)
      if (fold%element == 0) return
      help = 'a mesh made for the deformed shape, or finer where the body turns round an edge'
      if (has_necked(scene, model, fold%element)) help = 'the metal has necked there, one side '// &
         & 'of the element to less than a seventh: it tears, and beyond that no mesh bears it; '// &
         & 'less stroke, more hardening, or less friction'
      associate (worst => fold%element, node => fold%node, least => fold%value)
         call warn_once(scene%log, 'W0531', 'element '//to_text(model%mesh%element_label(worst))// &
            & ' is about to fold at node '//to_text(model%mesh%node_label(node))//' in step '// &
            & to_text(scene%step)//', increment '//to_text(increment)//': its scaled Jacobian '// &
            & 'is '//to_text(least, 3), model%step(scene%step)%at, help=help)
      end associate
   end subroutine check_mesh

   !> A side has shrunk to little of its length, and one that was beside it has not: metal that
   !> flows thins in one row of nodes.
   pure logical function has_necked(scene, model, e)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: e
      real(wp) :: x(model%mesh%ndim, 20), now(12), way(3, 12)
      integer :: n, k, edges

      has_necked = .false.
      if (.not. scene%newton%flows) return
      call place_corners(scene, model, scene%trial%motion%u, 1.0_wp, e, x, n)
      associate (cell => scene%solids%group(scene%solids%which(e))%element%cell, &
         & node => model%mesh%conn(:, e), start => model%mesh%x)
         edges = count(cell%edge(1, :) > 0)
         do k = 1, edges
            associate (a => cell%edge(1, k), b => cell%edge(2, k))
               now(k) = norm2(x(:, b) - x(:, a))/norm2(start(:, node(b)) - start(:, node(a)))
               way(:, k) = 0.0_wp
               way(:cell%ndim, k) = cell%xi(:cell%ndim, b) - cell%xi(:cell%ndim, a)
               way(:, k) = way(:, k)/norm2(way(:, k))
            end associate
         end do
         do k = 1, edges
            if (now(k) > necked) cycle
            has_necked = has_necked .or. any(now(:edges) > wider*now(k) &
               & .and. abs(matmul(way(:, k), way(:, :edges))) > parallel)
         end do
      end associate
   end function has_necked
end module lopin_check_mesh
