!> Elements of one group, several at a time (modules solid_batch and batch_end): added to forces and
!> tangent, stresses found, memory kept as one by one, with the same bits.
module lopin_assemble_batch
   use lopin_kinds, only : wp, ik
   use lopin_csc, only : csc_type
   use lopin_mesh, only : mesh_type
   use lopin_solids, only : solids_type
   use lopin_state, only : solids_state_type
   use lopin_material_memory, only : put_return, put_amplitudes
   use lopin_element_batch, only : batch_type, kept_type, lanes, most, points, &
      & put_memory
   use lopin_batch_kernel, only : compute_batch, compute_stresses, compute_kept
   use lopin_solid_configuration, only : configuration_type, share_type, take_nodes, add_nodes
   implicit none
   private
   public :: add_batch, recover_in_batch, remember_in_batch

   !> Elements from which on a batch, which computes all its lanes, takes less time than each alone.
   integer, parameter :: least = 3

contains

   !> Forces, energies and, if asked for, tangents of elements; not `done`: nothing is added.
   subroutine add_batch(shape, element, force, share, done, matrix)
      type(configuration_type), intent(in) :: shape
      integer, contiguous, intent(in) :: element(:)      !! of one batch of the solids
      real(wp), contiguous, intent(inout) :: force(:)
      type(share_type), contiguous, intent(inout) :: share(:)   !! (nelement)
      logical, intent(out) :: done
      type(csc_type), intent(inout), optional :: matrix
      type(batch_type) :: batch
      real(wp) :: own(3, 8)
      integer :: lane, e

      done = .false.
      if (.not. fits(shape%memory, element)) return
      associate (self => shape%solids, group => shape%solids%group(shape%solids%which(element(1))))
         call fill_lanes(shape, element, batch)
         call compute_batch(group%element, group%law, present(matrix), batch, done)
         if (.not. done) return
         associate (nnode => group%element%nnode)
            do lane = 1, size(element)
               e = element(lane)
               own = batch%force(lane, :, :)
               share(e)%energy = batch%energy(lane)
               call add_nodes(shape, shape%mesh%conn(:nnode, e), own(:, :nnode), force, share(e))
               if (present(matrix)) call add_lane(3*nnode, lane, batch%ke, &
                  & self%slot(self%first_slot(e):self%first_slot(e + 1) - 1), matrix%value)
            end do
         end associate
      end associate
   end subroutine add_batch

   !> Stresses and strains of elements at their points; not `done`: none.
   subroutine recover_in_batch(self, mesh, u, memory, element, stress, strain, done)
      type(solids_type), intent(in) :: self
      type(mesh_type), intent(in) :: mesh
      real(wp), intent(in) :: u(:, :)                    !! (>= ndim, nnode) [length]
      type(solids_state_type), intent(in) :: memory      !! of the accepted state
      integer, contiguous, intent(in) :: element(:)      !! of one batch of the solids
      real(wp), intent(inout) :: stress(:, :), strain(:, :)   !! (6, npoint)
      logical, intent(out) :: done
      type(batch_type) :: batch
      real(wp), dimension(lanes, 6, points) :: found, elongation
      integer :: lane, e, k, p

      done = .false.
      if (.not. fits(memory, element)) return
      associate (group => self%group(self%which(element(1))))
         do lane = 1, lanes
            e = element(min(lane, size(element)))
            associate (node => mesh%conn(:group%element%nnode, e))
               call fill_lane(self, memory, e, mesh%x(:, node), u(:3, node), lane, batch)
            end associate
         end do
         batch%dt = memory%dt
         call compute_stresses(group%element, group%law, batch, found, elongation, done)
         if (.not. done) return
         do lane = 1, size(element)
            p = self%first_point(element(lane)) - 1
            do k = 1, group%element%ngauss
               stress(:, p + k) = found(lane, :, k)
               strain(:, p + k) = elongation(lane, :, k)
            end do
         end do
      end associate
   end subroutine recover_in_batch

   !> What the points of elements keep of a trial, their plastic work and volumes; not `done`: none.
   subroutine remember_in_batch(shape, element, next, work, volume, done)
      type(configuration_type), intent(in) :: shape
      integer, contiguous, intent(in) :: element(:)      !! of one batch of the solids
      real(wp), contiguous, intent(inout) :: next(:, :)  !! (nmemory, ncolumn) the accepted state
      real(wp), contiguous, intent(inout) :: work(:), volume(:)   !! (nelement)
      logical, intent(out) :: done
      type(batch_type) :: batch
      type(kept_type) :: kept
      real(wp) :: density
      integer :: lane, e, k, p

      done = .false.
      if (.not. fits(shape%memory, element)) return
      associate (group => shape%solids%group(shape%solids%which(element(1))), &
         & first => shape%memory%first)
         if (.not. group%law%remembers) return
         call fill_lanes(shape, element, batch)
         call compute_kept(group%element, group%law, batch, kept, done)
         if (.not. done) return
         do lane = 1, size(element)
            e = element(lane)
            volume(e) = kept%held(lane)
            call put_amplitudes(next(:, first(e):first(e + 1) - 1), 6, &
               & kept%amplitude(lane, :group%element%nmode))
            do k = 1, group%element%ngauss
               if (.not. kept%step(lane, k) > 0.0_wp) cycle
               p = first(e) + k - 1
               next(:6, p) = next(:6, p) + kept%metric(lane, :, k)
               call put_return(next(:, p), 6, kept%step(lane, k), kept%stress(lane, k), density)
               work(e) = work(e) + kept%weight(lane, k)*density
            end do
         end do
      end associate
   end subroutine remember_in_batch

   !> Elements that a batch computes. States of the start that count volumes otherwise are rare: one
   !> by one.
   pure logical function fits(memory, element)
      type(solids_state_type), intent(in) :: memory
      integer, intent(in) :: element(:)

      fits = memory%finite_strain .and. .not. memory%scaled .and. size(element) >= least
   end function fits

   !> Nodes and memory of elements; lanes that are left hold the last one again.
   subroutine fill_lanes(shape, element, batch)
      type(configuration_type), intent(in) :: shape
      integer, contiguous, intent(in) :: element(:)
      type(batch_type), intent(inout) :: batch
      real(wp) :: x(3, most), moved(3, most)
      integer :: lane, e

      associate (self => shape%solids)
         associate (nnode => self%group(self%which(element(1)))%element%nnode)
            do lane = 1, lanes
               e = element(min(lane, size(element)))
               call take_nodes(shape, shape%mesh%conn(:nnode, e), x(:, :nnode), moved(:, :nnode))
               call fill_lane(self, shape%memory, e, x(:, :nnode), moved(:, :nnode), lane, batch)
            end do
         end associate
      end associate
      batch%dt = shape%memory%dt
   end subroutine fill_lanes

   !> Nodes and memory of an element.
   subroutine fill_lane(self, memory, e, x, moved, lane, batch)
      type(solids_type), intent(in) :: self
      type(solids_state_type), intent(in) :: memory
      integer, intent(in) :: e, lane
      real(wp), contiguous, intent(in) :: x(:, :), moved(:, :)   !! (3, nnode) [length]
      type(batch_type), intent(inout) :: batch

      batch%x(lane, :, :size(x, 2)) = x
      batch%u(lane, :, :size(x, 2)) = moved
      associate (group => self%group(self%which(e)))
         if (group%law%remembers) then
            call put_memory(group%element, batch, lane, &
               & memory%value(:, memory%first(e):memory%first(e + 1) - 1))
         else
            call put_memory(group%element, batch, lane, memory%none)
         end if
      end associate
   end subroutine fill_lane

   !> Add the lower triangle of the matrix of a lane to its slots; see add_slots of module solids.
   pure subroutine add_lane(ndof, lane, ke, slot, value)
      integer, intent(in) :: ndof, lane
      real(wp), intent(in) :: ke(lanes, 3*most, 3*most)
      integer(ik), contiguous, intent(in) :: slot(:)
      real(wp), contiguous, intent(inout) :: value(:)
      integer :: i, j, k

      k = 0
      do j = 1, ndof
         do i = j, ndof
            k = k + 1
            if (slot(k) > 0) then
               value(slot(k)) = value(slot(k)) + ke(lane, i, j)
            else if (slot(k) < 0) then
               value(-slot(k)) = value(-slot(k)) + 2.0_wp*ke(lane, i, j)
            end if
         end do
      end do
   end subroutine add_lane
end module lopin_assemble_batch
