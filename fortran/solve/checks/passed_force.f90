!> How much of the force of contact passes from point to point within an increment, beside metal
!> that flows there, and what each pair carries.
!>
!> Between two increments a point has closed, opened, or turned its force round a corner of the
!> tool: what passed is the sum of what closed, what opened, and |f - f0| - ||f| - |f0|| of those
!> that turned. Metal remembers it where it flows. So what passes counts as a whole where an element
!> at the point flows in the increment by what a first increment may flow (`first_flow`), and less
!> in proportion below: what goes from one elastic part of a sheet to another leaves nothing behind.
!> A master that deforms counts as a whole by the most that it flows.
module lopin_passed_force
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_mesh, only : mesh_type
   use lopin_material_memory, only : strain_at
   use lopin_first_increment, only : first_flow
   use lopin_scene, only : scene_type
   implicit none
   private
   public :: transfer_type, sum_transfers

   !> Sums over the points of a pair, where the increment begins and ends.
   type :: transfer_type
      real(wp) :: before = 0.0_wp, now = 0.0_wp   !! [force]
      real(wp) :: passed = 0.0_wp              !! from point to point, or round a corner [force]
      real(wp) :: remembered = 0.0_wp          !! of that, by metal that flows [force]
   end type transfer_type

contains

   !> What the points of each pair carry and hand over; pairs that the step takes away are let go
   !> of in their own way.
   pure subroutine sum_transfers(scene, model, of)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(transfer_type), intent(out) :: of(:)   !! (npair)
      real(wp) :: f0(3), f(3), flow(model%mesh%nnode), under(size(of)), passed
      integer :: i

      flow = flow_at_nodes(scene, model%mesh)/first_flow(model)
      under = [(flow_of_master(scene, i, flow), i=1, size(of))]
      associate (c => scene%newton%contact, old => scene%accepted%contact)
         do i = 1, c%n
            if (.not. c%pair_active(c%pair(i))) cycle
            f0 = c%weight(i)*old%traction(:, i)
            f = merge(c%weight(i)*c%traction(:, i), 0.0_wp, c%status(i) > 0)
            associate (sum => of(c%pair(i)), before => norm2(f0), now => norm2(f))
               sum%before = sum%before + before
               sum%now = sum%now + now
               passed = before + now
               if (before > 0.0_wp .and. now > 0.0_wp) passed = norm2(f - f0) - abs(now - before)
               sum%passed = sum%passed + passed
               sum%remembered = sum%remembered + passed*min(1.0_wp, max(flow(c%node(i)), &
                  & under(c%pair(i))))
            end associate
         end do
      end associate
   end subroutine sum_transfers

   !> Largest plastic strain of the increment in the elements at each node (nnode) [-].
   pure function flow_at_nodes(scene, mesh) result(flow)
      type(scene_type), intent(in) :: scene
      type(mesh_type), intent(in) :: mesh
      real(wp) :: flow(mesh%nnode), most
      integer :: e, k, p, q, row

      flow = 0.0_wp
      associate (old => scene%accepted%solids, new => scene%trial%solids, solids => scene%solids)
         do e = 1, mesh%nelement
            p = old%first(e)
            q = old%first(e + 1) - 1
            if (q < p) cycle
            row = strain_at(solids%group(solids%which(e))%element%nstress)
            most = maxval(new%value(row, p:q) - old%value(row, p:q))
            do k = 1, solids%group(solids%which(e))%element%nnode
               flow(mesh%conn(k, e)) = max(flow(mesh%conn(k, e)), most)
            end do
         end do
      end associate
   end function flow_at_nodes

   !> The largest of these at the master of a pair, if it deforms; else 0.
   pure real(wp) function flow_of_master(scene, pair, flow) result(most)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: pair
      real(wp), intent(in) :: flow(:)          !! (nnode)

      most = 0.0_wp
      associate (master => scene%newton%contact%masters%of(pair))
         if (master%tool > 0 .or. master%body > 0) return
         if (.not. allocated(master%surface%node)) return
         most = maxval(flow(master%surface%node(:master%surface%nnode)))
      end associate
   end function flow_of_master
end module lopin_passed_force
